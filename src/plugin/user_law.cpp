#include "plugin/user_law.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "input/sha256.hpp"
#include "plugin/helper_process.hpp"
#include "plugin/line_protocol.hpp"
#include "plugin/shared_library.hpp"

namespace osculate {

namespace {

namespace fs = std::filesystem;

std::string short_number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", x);
  return text;
}

std::string name_of(const UserLawOptions& law) {
  std::string out = "controller";
  if (!law.plugin.empty()) return out + " " + law.plugin;
  for (const auto& word : law.process) out += " " + word;
  return out;
}

/// Files that say what the law does: the library, or the program's arguments that are files.
std::vector<fs::path> files_of(const UserLawOptions& law) {
  std::vector<fs::path> out;
  std::error_code ignored;
  if (!law.plugin.empty()) out.emplace_back(law.plugin);
  for (const auto& word : law.process) {
    const bool searched = out.empty() && &word == &law.process.front() && word.find('/') == std::string::npos;
    const fs::path file = fs::path(law.directory) / word;
    if (!searched && fs::is_regular_file(file, ignored)) out.push_back(file);
  }
  return out;
}

/// The same numbers, bit for bit.
bool same(const std::vector<double>& a, const std::vector<double>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](double x, double y) {
    return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
  });
}

}  // namespace

class UserLaw::Helper {
 public:
  explicit Helper(const UserLawSetup& setup)
      : setup_(setup), process_([&setup](int socket) {
          return setup.law.plugin.empty() ? become_program(socket, setup.law) : serve_library(socket, setup);
        }) {
    deadline_ = after(setup.law.start_limit);
    if (is_library()) {
      const LibraryReply reply = receive_reply();
      if (reply.status != LibraryReply::fine) throw UserLawFailed(reply.message);
    } else {
      const std::string line = first_line(setup);
      try {
        process_.send(line.data(), line.size(), deadline_);
      } catch (const HelperGone&) {
        // It may have said why before it went: then that comes next, else this once more.
      }
      read_first_answer(receive_line());
    }
  }

  void torque(const osculate_controller_input& in, UserLawAnswer& out) {
    const auto velocities = static_cast<std::size_t>(in.velocities), rows = static_cast<std::size_t>(in.rows);
    deadline_ = after(setup_.law.time_limit);
    out.u.assign(in.u, in.u + rows);
    out.null_space_torque.assign(in.null_space_torque, in.null_space_torque + velocities);
    if (is_library())
      ask_library(in, out, velocities);
    else
      ask_program(in, out);
    require("torque", out.torque, velocities, "velocity coordinate");
    require("u", out.u, rows, "task row");
    require("null_space_torque", out.null_space_torque, velocities, "velocity coordinate");
  }

 private:
  static HelperProcess::Deadline after(double seconds) {
    return std::chrono::steady_clock::now() +
           std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::duration<double>(seconds));
  }
  bool is_library() const { return !setup_.law.plugin.empty(); }

  void ask_library(const osculate_controller_input& in, UserLawAnswer& out, std::size_t velocities) {
    const std::vector<char> bytes = packed(in);
    process_.send(bytes.data(), bytes.size(), deadline_);
    const LibraryReply reply = receive_reply();
    if (reply.status == LibraryReply::refused) throw Refusal(reply.message);
    if (reply.status == LibraryReply::overrun)
      throw BadAnswer(std::string("wrote past the end of ") + reply.message,
                      "there is one number for each velocity coordinate, of u one for each task row");
    out.torque.resize(velocities);
    for (auto* numbers : {&out.torque, &out.u, &out.null_space_torque})
      receive(reinterpret_cast<char*>(numbers->data()), numbers->size() * sizeof(double));
  }

  void ask_program(const osculate_controller_input& in, UserLawAnswer& out) {
    if (!pending_.empty())
      throw BadAnswer("has printed more than one line for one question",
                      "print one answer for each line that it reads, and nothing else to standard output");
    const std::string line = question(in);
    process_.send(line.data(), line.size(), deadline_);
    read_answer(receive_line(), out);
  }

  void receive(char* data, std::size_t size) {
    while (size > 0) {
      const std::size_t got = process_.receive(data, size, deadline_);
      data += got;
      size -= got;
    }
  }
  LibraryReply receive_reply() {
    LibraryReply out;
    receive(reinterpret_cast<char*>(&out), sizeof out);
    return out;
  }
  /// The next line, without its end. What follows it waits in `pending_`.
  std::string receive_line() {
    const std::size_t longest = 100'000 + 100 * static_cast<std::size_t>(setup_.model.velocities);
    std::size_t end = pending_.find('\n');
    while (end == std::string::npos) {
      if (pending_.size() > longest)
        throw BadAnswer("printed a line of more than " + std::to_string(longest) + " bytes",
                        "end each answer with a new line");
      char block[4096];
      const std::size_t got = process_.receive(block, sizeof block, deadline_);
      pending_.append(block, got);
      end = pending_.find('\n', pending_.size() - got);
    }
    std::string out = pending_.substr(0, end);
    pending_.erase(0, end + 1);
    return out;
  }

  static void require(const char* what, const std::vector<double>& numbers, std::size_t size,
                      const char* counted) {
    if (numbers.size() != size)
      throw BadAnswer("gave " + std::to_string(numbers.size()) + " numbers as " + what + " and not " +
                          std::to_string(size),
                      std::string("give one for each ") + counted);
    for (std::size_t i = 0; i < size; ++i)
      if (!std::isfinite(numbers[i]))
        throw NotFinite(
            std::string("gave ") + what + "[" + std::to_string(i) + "] = " + short_number(numbers[i]),
            "every number must be set, and finite");
  }

  const UserLawSetup& setup_;
  HelperProcess process_;
  HelperProcess::Deadline deadline_;
  std::string pending_;
};

/// What all copies of a law have in common.
struct UserLaw::Shared {
  std::shared_ptr<Helper> first;  // started with the law; a copy with a memory takes it away
  bool asked = false;
  std::string failure;  // of a process that is of no more use
};

namespace {

[[noreturn]] void fail(const UserLawSetup& setup, const std::string& what, const std::string& remedy) {
  throw UserLawFailed(name_of(setup.law) + " " + what + ": " + remedy);
}

[[noreturn]] void fail_late(const UserLawSetup& setup, const std::string& when, double limit,
                            const char* key) {
  fail(setup, "gave no answer within " + short_number(limit) + " s " + when + " and was killed",
       std::string("make it answer, or raise controller.law.") + key);
}

[[noreturn]] void fail_gone(const UserLawSetup& setup, const std::string& how, const std::string& when) {
  fail(setup, how + " " + when,
       setup.law.plugin.empty()
           ? "what it wrote to standard error stands above; it must answer each line "
             "until its input ends"
           : "compile it with -g and call it with the inputs of that time under a debugger");
}

}  // namespace

UserLaw::UserLaw(std::shared_ptr<const UserLawSetup> setup)
    : setup_(std::move(setup)), shared_(std::make_shared<Shared>()) {
  std::error_code ignored;
  const std::string& library = setup_->law.plugin;
  if (!library.empty() && !fs::is_regular_file(library, ignored))
    fail(*setup_, "is no file", "build it as a shared library (cc -shared -fPIC)");
  shared_->first = start();
}

UserLaw::UserLaw(const UserLaw& other) : setup_(other.setup_), shared_(other.shared_) {}

UserLaw& UserLaw::operator=(const UserLaw& other) {
  setup_ = other.setup_;
  shared_ = other.shared_;
  helper_.reset();
  return *this;
}

std::shared_ptr<UserLaw::Helper> UserLaw::start() const {
  const std::string when = "when it was started";
  try {
    return std::make_shared<Helper>(*setup_);
  } catch (const UserLawFailed& error) {
    throw UserLawFailed(name_of(setup_->law) + " " + error.what());
  } catch (const HelperLate&) {
    fail_late(*setup_, when, setup_->law.start_limit, "start_limit");
  } catch (const HelperGone& error) {
    fail_gone(*setup_, error.what(), when);
  } catch (const BadAnswer& error) {
    fail(*setup_, std::string(error.what()) + " " + when, error.remedy);
  } catch (const Refusal& error) { fail(*setup_, "refuses to start", error.what()); }
}

void UserLaw::ask(const osculate_controller_input& in) {
  helper_->torque(in, answer_);
  const bool pure = setup_->model.period == 0;
  if (!pure || shared_->asked) return;
  shared_->asked = true;
  const UserLawAnswer before = answer_;
  helper_->torque(in, answer_);
  if (!same(before.torque, answer_.torque) || !same(before.u, answer_.u) ||
      !same(before.null_space_torque, answer_.null_space_torque))
    throw BadAnswer("gave two different answers to the same question",
                    "a law without controller.sampling must be a function of its inputs alone; give "
                    "controller.sampling to a law with a memory");
}

const UserLawAnswer& UserLaw::torque(const osculate_controller_input& in) {
  if (!shared_->failure.empty()) throw UserLawFailed(shared_->failure);
  const std::string when = "at t = " + short_number(in.t) + " s";
  const auto for_good = [this](const auto& complain) {
    try {
      complain();
    } catch (const UserLawFailed& error) {
      shared_->failure = error.what();
      throw;
    }
  };
  if (!helper_) {
    helper_ = shared_->first;
    if (setup_->model.period > 0) shared_->first.reset();
    if (!helper_) helper_ = start();
  }
  try {
    ask(in);
  } catch (const NotFinite& error) {
    fail(*setup_, std::string(error.what()) + " " + when, error.remedy);
  } catch (const Refusal& error) {
    const std::string why = error.what();
    for_good([&] { fail(*setup_, "refuses to go on " + when, why.empty() ? "it gives no reason" : why); });
  } catch (const BadAnswer& error) {
    for_good([&] { fail(*setup_, std::string(error.what()) + " " + when, error.remedy); });
  } catch (const HelperLate&) {
    for_good([&] { fail_late(*setup_, when, setup_->law.time_limit, "time_limit"); });
  } catch (const HelperGone& error) {
    for_good([&] { fail_gone(*setup_, error.what(), when); });
  }
  return answer_;
}

std::string fingerprint(const UserLawOptions& law) {
  std::string out;
  for (const fs::path& file : files_of(law)) {
    std::ifstream in(file, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    out += sha256(bytes) + "  " + file.lexically_normal().string() + "\n";
  }
  return out;
}

}  // namespace osculate
