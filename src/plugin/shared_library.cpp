#include "plugin/shared_library.hpp"

#include <dlfcn.h>

#include <algorithm>
#include <bit>
#include <cstdio>
#include <cstring>
#include <limits>

#include "plugin/helper_process.hpp"

namespace osculate {

namespace {

/// The arrays that follow an input on the socket: pointer, length. The terms come together or not at all.
template <class Use>
void for_each_array(osculate_controller_input& in, Use use) {
  const auto np = static_cast<std::size_t>(in.positions), nv = static_cast<std::size_t>(in.velocities),
             m = static_cast<std::size_t>(in.rows);
  use(in.q, np);
  use(in.qd, nv);
  use(in.u, m);
  use(in.null_space_torque, nv);
  if (in.M == nullptr) return;
  use(in.M, nv * nv);
  use(in.C, nv);
  use(in.G, nv);
  use(in.J, m * nv);
  use(in.Jdot_qd, m);
}

/// An array that the law may write to, with a mark after it.
class Guarded {
 public:
  explicit Guarded(std::size_t size) : numbers_(size + marks, mark()) {}
  double* data() { return numbers_.data(); }
  std::size_t size() const { return numbers_.size() - marks; }
  bool overrun() const {
    return std::any_of(numbers_.end() - marks, numbers_.end(), [](double x) {
      return std::bit_cast<std::uint64_t>(x) != std::bit_cast<std::uint64_t>(mark());
    });
  }

 private:
  static constexpr int marks = 8;
  static double mark() { return std::bit_cast<double>(std::uint64_t{0x7ff8'0e7e'a11e'd000}); }  // a NaN
  std::vector<double> numbers_;
};

class Library {
 public:
  explicit Library(const UserLawSetup& setup) {
    void* const library = dlopen(setup.law.plugin.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (library == nullptr) {
      const char* why = dlerror();
      throw UserLawFailed(std::string("cannot be loaded: ") + (why != nullptr ? why : "unknown reason") +
                          "; build it as a shared library (cc -shared -fPIC)");
    }
    const auto find = [library](const char* symbol, auto& out) {
      out = reinterpret_cast<std::remove_reference_t<decltype(out)>>(dlsym(library, symbol));
      return out != nullptr;
    };
    std::int32_t (*abi)() = nullptr;
    if (!find("osculate_controller_abi", abi))
      throw UserLawFailed(
          "has no symbol osculate_controller_abi: write OSCULATE_CONTROLLER_PLUGIN once in its source, after "
          "#include <osculate/controller.h>");
    if (const int has = abi(); has != OSCULATE_CONTROLLER_ABI)
      throw UserLawFailed("was compiled for version " + std::to_string(has) +
                          " of the controller interface, this osculate has version " +
                          std::to_string(OSCULATE_CONTROLLER_ABI) + ": compile it with its header");
    if (!find("osculate_controller_torque", torque_))
      throw UserLawFailed(
          "has no symbol osculate_controller_torque: define that function, in C++ with extern \"C\"");
    find("osculate_controller_destroy", destroy_);
    decltype(&osculate_controller_create) create = nullptr;
    if (find("osculate_controller_create", create)) call_create(create, setup);
  }
  ~Library() {
    if (destroy_ != nullptr) destroy_(self_);
  }
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;

  int torque(const osculate_controller_input& in, osculate_controller_output& out) {
    return torque_(self_, &in, &out);
  }

 private:
  void call_create(decltype(&osculate_controller_create) create, const UserLawSetup& setup) {
    const UserLawModel& m = setup.model;
    std::vector<const char*> names;
    for (const auto& name : m.joints) names.push_back(name.c_str());
    const std::vector<std::int32_t> row(m.rows.begin(), m.rows.end());
    osculate_controller_model model{};
    model.size = sizeof model;
    model.urdf = m.urdf.c_str();
    model.base = m.base.c_str();
    model.tip = m.tip.c_str();
    model.lump_side_branches = m.lump_side_branches;
    std::copy(m.gravity.begin(), m.gravity.end(), model.gravity);
    model.joints = static_cast<std::int32_t>(names.size());
    model.positions = m.positions;
    model.velocities = m.velocities;
    model.joint_names = names.data();
    model.armature = m.armature.data();
    model.rows = static_cast<std::int32_t>(row.size());
    model.row = row.data();
    std::copy(m.stiffness.begin(), m.stiffness.end(), model.stiffness);
    std::copy(m.damping.begin(), m.damping.end(), model.damping);
    model.period = m.period;
    model.options = setup.law.options.c_str();
    LibraryReply reply;
    const int code = create(&model, &self_, reply.message, sizeof reply.message);
    reply.message[sizeof reply.message - 1] = '\0';
    if (code == 0) return;
    destroy_ = nullptr;
    throw UserLawFailed("refuses to start (osculate_controller_create returned " + std::to_string(code) +
                        "): " + (reply.message[0] != '\0' ? reply.message : "it gives no message"));
  }

  void* self_ = nullptr;
  decltype(&osculate_controller_torque) torque_ = nullptr;
  decltype(&osculate_controller_destroy) destroy_ = nullptr;
};

void say(LibraryReply& reply, LibraryReply::Status status, const char* message) {
  reply.status = status;
  std::snprintf(reply.message, sizeof reply.message, "%s", message);
}

bool send(int socket, const LibraryReply& reply) {
  return send_all(socket, reinterpret_cast<const char*>(&reply), sizeof reply);
}

/// One question after the other. Returns when the parent is gone.
void answer(int socket, Library& library) {
  osculate_controller_input in{};
  std::vector<double> numbers;
  std::vector<char> bytes;
  while (receive_all(socket, reinterpret_cast<char*>(&in), sizeof in)) {
    std::size_t count = 0;
    for_each_array(in, [&](const double*&, std::size_t size) { count += size; });
    numbers.resize(count);
    std::vector<std::int32_t> row(static_cast<std::size_t>(in.rows));
    if (!receive_all(socket, reinterpret_cast<char*>(row.data()), row.size() * sizeof row[0]) ||
        !receive_all(socket, reinterpret_cast<char*>(numbers.data()), count * sizeof numbers[0]))
      return;
    const double* next = numbers.data();
    for_each_array(in, [&](const double*& array, std::size_t size) {
      array = next;
      next += size;
    });
    in.row = row.data();

    Guarded torque(static_cast<std::size_t>(in.velocities)), u(row.size()), T0(torque.size());
    std::fill_n(torque.data(), torque.size(), std::numeric_limits<double>::quiet_NaN());
    std::copy_n(in.u, u.size(), u.data());
    std::copy_n(in.null_space_torque, T0.size(), T0.data());
    LibraryReply reply;
    osculate_controller_output out{};
    out.size = sizeof out;
    out.torque = torque.data();
    out.u = u.data();
    out.null_space_torque = T0.data();
    out.message = reply.message;
    out.message_capacity = sizeof reply.message;
    try {
      if (library.torque(in, out) != 0) reply.status = LibraryReply::refused;
    } catch (const std::exception& error) {
      say(reply, LibraryReply::refused, (std::string("it threw an exception: ") + error.what()).c_str());
    }
    reply.message[sizeof reply.message - 1] = '\0';
    for (const auto& [array, name] : {std::pair{&torque, "torque"}, {&u, "u"}, {&T0, "null_space_torque"}})
      if (array->overrun()) say(reply, LibraryReply::overrun, name);
    bytes.clear();
    const auto add = [&bytes](const void* data, std::size_t size) {
      const char* first = static_cast<const char*>(data);
      bytes.insert(bytes.end(), first, first + size);
    };
    add(&reply, sizeof reply);
    if (reply.status == LibraryReply::fine)
      for (Guarded* array : {&torque, &u, &T0}) add(array->data(), array->size() * sizeof(double));
    if (!send_all(socket, bytes.data(), bytes.size())) return;
  }
}

}  // namespace

std::vector<char> packed(const osculate_controller_input& question) {
  osculate_controller_input in = question;
  std::vector<char> out(sizeof in);
  std::memcpy(out.data(), &in, sizeof in);
  const auto add = [&out](const auto* data, std::size_t count) {
    const char* first = reinterpret_cast<const char*>(data);
    out.insert(out.end(), first, first + count * sizeof *data);
  };
  add(in.row, static_cast<std::size_t>(in.rows));
  for_each_array(in, add);
  return out;
}

int serve_library(int socket, const UserLawSetup& setup) {
  LibraryReply reply;
  try {
    Library library(setup);
    if (!send(socket, reply)) return 0;
    answer(socket, library);
    return 0;
  } catch (const std::exception& error) { say(reply, LibraryReply::refused, error.what()); }
  send(socket, reply);
  return 1;
}

}  // namespace osculate
