// A control law that somebody else wrote, in a process of its own: a shared library with the interface of
// include/osculate/controller.h, or a program that speaks the line protocol of docs/your-controller.md.
#pragma once

#include <array>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

struct osculate_controller_input;

namespace osculate {

/// It gave no answer that can be used. The message names the controller, the time, what happened and what to
/// do.
struct UserLawFailed : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct UserLawOptions {
  std::string plugin;                // a shared library; empty: `process`
  std::vector<std::string> process;  // a program and its arguments
  std::string directory;             // where the program runs
  std::string options;               // for the law to read
  bool terms = false;                // the law is given M, C, G, J and Jdot qd
  double time_limit = 1;             // s, > 0, for each answer
  double start_limit = 30;           // s, > 0, until it is ready
  bool operator==(const UserLawOptions&) const = default;
};

/// What the law is told once: osculate_controller_model.
struct UserLawModel {
  std::string urdf, base, tip;
  bool lump_side_branches = true;
  std::array<double, 3> gravity{};  // m/s^2
  std::vector<std::string> joints;
  int positions = 0, velocities = 0;
  std::vector<double> armature;  // velocities
  std::vector<int> rows;
  std::array<double, 6> stiffness{}, damping{};
  double period = 0;  // s; 0: called at every instant
};

struct UserLawSetup {
  UserLawOptions law;
  UserLawModel model;
};

struct UserLawAnswer {
  std::vector<double> torque, u, null_space_torque;  // finite; as many as there are coordinates and rows
};

/// Copies of a law that is called at every instant share one process. Of a sampled law, which may have a
/// memory, each copy that is used has its own, and begins anew.
class UserLaw {
 public:
  /// No law.
  UserLaw() = default;
  /// Starts the process, which loads the library or is the program. Throws UserLawFailed.
  explicit UserLaw(std::shared_ptr<const UserLawSetup> setup);
  UserLaw(const UserLaw&);
  UserLaw& operator=(const UserLaw&);
  UserLaw(UserLaw&&) noexcept = default;
  UserLaw& operator=(UserLaw&&) noexcept = default;
  ~UserLaw() = default;

  /// Throws UserLawFailed. The result lasts until the next call. Of a law that is called at every instant the
  /// first answer is asked for twice: one that differs shows a memory.
  const UserLawAnswer& torque(const osculate_controller_input& in);

 private:
  class Helper;
  struct Shared;
  std::shared_ptr<Helper> start() const;
  void ask(const osculate_controller_input& in);

  std::shared_ptr<const UserLawSetup> setup_;
  std::shared_ptr<Shared> shared_;  // by all copies
  std::shared_ptr<Helper> helper_;
  UserLawAnswer answer_;
};

/// One line "SHA-256  path" for the library, or for each argument of the program that is a file.
std::string fingerprint(const UserLawOptions& law);

}  // namespace osculate
