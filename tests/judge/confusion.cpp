// Which mistakes judge() names, one at a time and in pairs, on simulated logs of three arms.
//   judge_confusion            the table as Markdown; exit 1 where a mistake was not named or another one was
//   judge_confusion ARM A B    one log, in words
#include <algorithm>
#include <cstdio>
#include <iostream>

#include "judge/judge.hpp"
#include "judge/wrong_law.hpp"

using namespace osculate;

namespace {

const std::vector<std::string> terms{"jdot_qd", "coriolis", "gravity", "armature", "viscous", "payload"};
const std::vector<std::string> singles{
    "uncoupled_lambda", "swapped_rows",         "u_in_tip_frame", "u_turned_to_tip",
    "tip_point",        "spatial_acceleration", "delay"};

bool turned(const Mistakes& made) {
  return made.contains("swapped_rows") || made.contains("u_in_tip_frame") || made.contains("u_turned_to_tip");
}

std::string joined(const Mistakes& mistakes) {
  std::string out;
  for (const auto& m : mistakes) out += (out.empty() ? "" : " + ") + m;
  return out.empty() ? "nothing" : out;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1) {
    const JudgedArm arm = judged_arm(argv[1]);
    const Log log = simulate(arm, Mistakes(argv + 2, argv + argc),
                             {.in_charge = !turned(Mistakes(argv + 2, argv + argc))});
    std::cout << report(judge(arm.chain, log, judge_options(arm)), log.source);
    return 0;
  }
  std::vector<Mistakes> cases{{}};
  for (std::size_t i = 0; i < terms.size(); ++i) {
    cases.push_back({terms[i]});
    for (std::size_t j = 0; j < i; ++j) cases.push_back({terms[i], terms[j]});
  }
  for (const auto& single : singles) cases.push_back({single});
  int wrong = 0;
  std::printf("| made | puma560 | ur5e_like | arm7 |\n|---|---|---|---|\n");
  for (const Mistakes& made : cases) {
    std::printf("| %s |", joined(made).c_str());
    for (const char* name : {"puma560", "ur5e_like", "arm7"}) {
      const JudgedArm arm = judged_arm(name);
      // With u turned the loop is unstable: then the right law moves the arm.
      const Log log = simulate(arm, made, {.in_charge = !turned(made)});
      const Judgement judgement = judge(arm.chain, log, judge_options(arm));
      const bool right = named(judgement) == made;
      wrong += right ? 0 : 1;
      std::printf(" %s%s |", right ? "named" : joined(named(judgement)).c_str(),
                  judgement.doubts.empty() ? "" : ", not sure");
      std::fflush(stdout);
    }
    std::printf("\n");
  }
  return wrong > 0;
}
