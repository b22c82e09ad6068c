#include "record/texts.hpp"

#include "record/hdf5_whole.hpp"

namespace osculate {

using hdf5::Check;
using hdf5::Handle;

ResultTexts read_texts(const std::filesystem::path& file) {
  const Check check{file, ""};
  const Handle opened = hdf5::open_result(file, check);
  const Handle root = check(H5Gopen2(opened, "/", H5P_DEFAULT), H5Gclose, "open the root group");
  const auto status = hdf5::text_attribute(root, "status");
  if (!status)
    throw FileError(file.string() + ": is not a result file of osculate: it has no root attribute 'status'");
  const hdf5::Input input = hdf5::read_input(root, check);
  ResultTexts out;
  out.status = *status;
  for (const Text& text : input.layout.texts) out.texts[text.path] = text.value;
  for (const StringList& list : input.layout.lists) out.lists[list.path] = list.values;
  for (const Axis& axis : input.layout.axes) out.lists[axis.name] = axis.labels;
  return out;
}

void read_all(const std::filesystem::path& file, const std::function<void()>& alive) {
  const hdf5::WholeFile whole = hdf5::open_whole(file, hdf5::Part::everything);
  for (const hdf5::Dataset& dataset : whole.datasets) {
    alive();
    if (dataset.type == hdf5::Type::text) hdf5::read_strings(dataset.id, dataset.path, whole.check);
    if (dataset.type != hdf5::Type::real && dataset.type != hdf5::Type::whole) continue;
    for (hsize_t first = 0; first < dataset.rows(); first += hdf5::block_rows) {
      hdf5::read_words(dataset, first, std::min(hdf5::block_rows, dataset.rows() - first), whole.check);
      alive();
    }
  }
}

}  // namespace osculate
