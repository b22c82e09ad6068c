#include <charconv>
#include <string_view>

#include "input/limits.hpp"
#include "input/named_columns.hpp"
#include "input/read_text.hpp"

namespace osculate {

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view blank = " \t\r";
  const auto begin = text.find_first_not_of(blank);
  return begin == text.npos ? std::string_view{}
                            : text.substr(begin, text.find_last_not_of(blank) - begin + 1);
}

std::vector<std::string_view> fields_of(std::string_view line) {
  std::vector<std::string_view> out;
  for (;;) {
    const auto comma = line.find(',');
    out.push_back(trimmed(line.substr(0, comma)));
    if (comma == line.npos) return out;
    line.remove_prefix(comma + 1);
  }
}

ColumnsFile read_csv(const std::filesystem::path& file) {
  auto [text, fault] = read_text(file, limits::log_bytes, "give a CSV file with a header of names");
  ColumnsFile out;
  if (!fault.empty()) return {{}, fault};
  const auto fail = [&](int line, const std::string& what) {
    return ColumnsFile{{}, file.string() + ":" + std::to_string(line) + ": " + what};
  };
  std::string_view rest = text;
  if (rest.starts_with(byte_order_mark)) rest.remove_prefix(byte_order_mark.size());
  for (int number = 1; !rest.empty(); ++number) {
    const auto end = rest.find('\n');
    const std::string_view line = trimmed(rest.substr(0, end));
    rest.remove_prefix(end == rest.npos ? rest.size() : end + 1);
    if (line.empty() || line.front() == '#') continue;
    const auto items = fields_of(line);
    NamedColumns& table = out.table;
    if (table.names.empty()) {
      for (std::string_view item : items) {
        while (item.starts_with('"')) item.remove_prefix(1);
        while (item.ends_with('"')) item.remove_suffix(1);
        table.names.emplace_back(item);
      }
      table.columns.resize(items.size());
      continue;
    }
    if (items.size() != table.names.size())
      return fail(number, "has " + std::to_string(items.size()) + " fields under a header of " +
                              std::to_string(table.names.size()) + "; give one number for each column");
    for (std::size_t i = 0; i < items.size(); ++i) {
      std::string_view digits = items[i];
      if (digits.size() > 1 && digits[0] == '+' && digits[1] != '-') digits.remove_prefix(1);
      double value = 0;
      const auto [stop, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
      if (error != std::errc{} || stop != digits.data() + digits.size())
        return fail(number, table.names[i] + " = '" + std::string(items[i]) + "': must be a number");
      table.columns[i].push_back(value);
    }
  }
  if (out.table.rows() == 0) return fail(1, "holds no rows of numbers; give a header of names and samples");
  return out;
}

}  // namespace osculate
