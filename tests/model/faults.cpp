// What the loader does with every kind of bad file: which are errors, which are warnings, and what is said.
#include <fcntl.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <vector>

#include "urdf_text.hpp"

namespace osculate::testing::faults_tests {
using namespace urdf_text;

// urdfdom itself loses the links of a file without a root: shared pointers in a ring. Not ours to free.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() { return "leak:liburdfdom_model"; }

namespace {

struct Fault {
  std::string what, text;
  std::vector<std::string> said;
};

std::vector<Fault> faults() {
  std::vector<Fault> all;
  const auto add = [&](const char* what, const std::string& text, std::initializer_list<const char*> said) {
    all.push_back({what, text, {said.begin(), said.end()}});
  };
  const auto tree = a_link("base", "") + a_link("one") + a_link("two") + a_joint("j1", "base", "one");

  // refused by the XML library or by urdfdom: the reason comes from its log
  add("empty", "", {"document empty", "well-formed"});
  add("truncated", "<robot name=\"r\"><link name=\"base\"/><link na", {"Error", "complete, well-formed XML"});
  add("no robot", "<model/>", {"'robot' element"});
  add("document type", "<!DOCTYPE r [<!ENTITY a \"b\">]>" + two_links(), {"'robot' element", "entities"});
  add("no robot name", "<robot><link name=\"two\"/></robot>", {"No name given for the robot"});
  add("no links", robot(""), {"No link elements", "at least two links"});
  add("xacro", robot("<xacro:arm prefix=\"x\"/>"), {"xacro file", "expand"});
  add("zero byte", std::string("<robot\0 name", 12), {"byte 6 is zero", "UTF-8"});
  add("duplicate link", robot(a_link("two") + a_link("two")),
      {"link 'two' is not unique", "name of its own"});
  add("duplicate joint", robot(tree + a_joint("j1", "one", "two")), {"joint 'j1' is not unique"});
  add("duplicate material",
      robot("<material name=\"m\"><color rgba=\"1 1 1 1\"/></material>"
            "<material name=\"m\"><color rgba=\"1 1 1 1\"/></material>" +
            a_link("two")),
      {"material 'm' is not unique"});
  add("unknown type", robot(tree + a_joint("j2", "one", "two", "ball")),
      {"[j2]", "[ball]", "Types are revolute"});
  add("no limit", two_links(ball, "<axis xyz=\"0 0 1\"/>"),
      {"[j2]", "does not specify limits", "Add <limit"});
  add("prismatic without limit", robot(tree + a_joint("j2", "one", "two", "prismatic", "")),
      {"[j2]", "without limits", "Add <limit"});
  add("limit without effort", two_links(ball, "<limit lower=\"-1\" upper=\"1\" velocity=\"1\"/>"),
      {"no effort", "[j2]", "both effort and velocity"});
  add("limit without velocity", two_links(ball, "<limit lower=\"-1\" upper=\"1\" effort=\"1\"/>"),
      {"no velocity", "[j2]"});
  add("undefined parent", robot(tree + a_joint("j2", "world", "two")), {"parent link [world]", "[j2]"});
  add("undefined child", robot(tree + a_joint("j2", "one", "three")),
      {"child link [three]", "[j2]", "Define that link"});
  add("joint without parent", robot(tree + "<joint name=\"j2\" type=\"fixed\"><child link=\"two\"/></joint>"),
      {"[j2]", "missing a parent"});
  add("several roots", robot(tree), {"Two root links found", "[base]", "[two]", "connect them"});
  add("tab in a vector", two_links(ball, "<origin xyz=\"0 0\t1\"/>" + limit), {"[j2]", "single spaces"});
  add("two numbers", two_links(ball, "<origin xyz=\"0 0\"/>" + limit), {"[j2]", "exactly three"});
  add("four numbers", two_links(ball, "<axis xyz=\"0 0 1 0\"/>" + limit), {"[j2]", "exactly three"});
  add("nan in an origin", two_links(ball, "<origin xyz=\"0 nan 0\"/>" + limit), {"[nan]", "[j2]"});
  add("unnamed joint",
      robot(tree + "<joint type=\"fixed\"><parent link=\"one\"/><child link=\"two\"/></joint>"),
      {"unnamed joint"});
  // loaded by urdfdom without a word, or with a word to its log only
  add("unnamed link", robot("<link/>"), {"a <link> has no name"});
  add("no inertia", two_links("<inertial><mass value=\"1\"/></inertial>"),
      {"link 'one'", "<inertial> cannot be read", "must have inertia element", "Correct it"});
  add("no mass",
      two_links(
          "<inertial><inertia ixx=\"1\" iyy=\"1\" izz=\"1\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial>"),
      {"link 'one'", "must have a mass element"});
  add("mass nan", two_links(inertial("nan", 1, 1, 1)), {"link 'one'", "mass [nan]"});
  add("mass inf", two_links(inertial("inf", 1, 1, 1)), {"link 'one'", "mass [inf]"});
  add("mass one", two_links(inertial("one", 1, 1, 1)), {"link 'one'", "mass [one]"});
  add("decimal comma", two_links(inertial("1,5", 1, 1, 1)), {"link 'one'", "mass [1,5]"});
  add("no izz",
      two_links("<inertial><mass value=\"1\"/><inertia ixx=\"1\" iyy=\"1\" ixy=\"0\" ixz=\"0\" "
                "iyz=\"0\"/></inertial>"),
      {"link 'one'", "izz"});
  add("bad inertial origin", two_links("<inertial><origin xyz=\"0 0\"/><mass value=\"1\"/></inertial>"),
      {"link 'one'", "3 expected"});
  add("negative mass", two_links(inertial("-1.5", 1, 1, 1)), {"link 'one'", "mass -1.5 kg is negative"});
  add("negative inertia", two_links(inertial("1", -0.1, -0.1, -0.1)),
      {"link 'one'", "(-0.1, -0.1, -0.1)", "none below 0"});
  add("indefinite inertia", two_links(inertial("1", 0.1, 0.1, 0.1, 0.2)),
      {"link 'one'", "(-0.1, 0.1, 0.3)", "products of inertia"});
  add("overflowing inertia",
      two_links("<inertial><origin xyz=\"0 0 0\" rpy=\"1 1 1\"/><mass value=\"1\"/>"
                "<inertia ixx=\"1.7e308\" iyy=\"1.7e308\" izz=\"1.7e308\" ixy=\"1.7e308\" "
                "ixz=\"1.7e308\" iyz=\"1.7e308\"/></inertial>"),
      {"link 'one'", "finite"});
  add("overflowing position",
      robot(a_link("base", "") + a_link("one") + a_link("two") + a_joint("j1", "base", "one") +
            a_joint("f", "one", "mid", "fixed", "<origin xyz=\"1.7e308 0 0\"/>") + a_link("mid") +
            a_joint("j2", "mid", "two", "revolute", "<origin xyz=\"1.7e308 0 0\"/>" + limit)),
      {"joint 'j2'", "not finite"});
  add("overflowing moment",
      robot(a_link("base", "") + a_link("one") + a_link("two") + a_joint("j1", "base", "one") +
            a_joint("j2", "one", "two") + a_link("far") +
            a_joint("f", "two", "far", "fixed", "<origin xyz=\"1e200 0 0\"/>")),
      {"link 'two'", "lumped into it", "not a finite number"});
  add("zero axis", two_links(ball, "<axis xyz=\"0 0 0\"/>" + limit),
      {"joint 'j2'", "axis (0 0 0)", "non-zero vector"});
  add("axis without numbers", two_links(ball, "<axis/>" + limit), {"joint 'j2'", "axis (0 0 0)"});
  add("mimic", two_links(ball, "<mimic joint=\"j1\"/>" + limit),
      {"joint 'j2'", "mimics joint 'j1'", "independent"});
  // no tree
  add("two parents", robot(tree + a_joint("j2", "one", "two") + a_joint("j0", "base", "two", "fixed", "")),
      {"link 'two'", "two parent joints", "'j0' (from link 'base')", "'j2' (from link 'one')", "remove one"});
  add("its own parent", robot(tree + a_joint("j2", "two", "two")),
      {"link 'two'", "its own ancestor", "joint 'j2'"});
  add("no root",
      robot(a_link("one") + a_link("two") + a_joint("a", "one", "two") + a_joint("b", "two", "one")),
      {"its own ancestor", "link 'one'", "joint 'a'", "joint 'b'"});
  add("detached cycle", robot(tree + a_link("x") + a_joint("a", "x", "two") + a_joint("b", "two", "x")),
      {"its own ancestor", "'two'", "'x'", "joint 'a'", "joint 'b'"});
  return all;
}

struct CommaDecimals : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

/// The global C++ locale, given back at the end of the scope.
struct GlobalLocale {
  std::locale before;
  explicit GlobalLocale(const std::locale& now) : before(std::locale::global(now)) {}
  ~GlobalLocale() { std::locale::global(before); }
};

std::string data(const std::string& name) {
  return std::string(OSCULATE_SOURCE_DIR) + "/tests/model/data/" + name;
}

std::string error_of_file(const std::filesystem::path& file) {
  try {
    ChainChoice choice;
    choice.tip = "two";
    load_urdf(file, choice);
  } catch (const ModelError& error) { return error.what(); }
  return "";
}

}  // namespace

TEST_CASE("the file that the faults are put into is a good one") {
  const auto arm = load(two_links());
  CHECK(arm.chain.n() == 2);
  CHECK(arm.warnings.empty());
  CHECK(arm.inertia_concerns.empty());
}

TEST_CASE("every single fault is an error that names the file, the place and the reason") {
  for (const auto& fault : faults()) {
    const std::string message = error_of(fault.text);
    INFO(fault.what << ": " << message);
    CHECK(message.starts_with("arm.urdf: "));
    CHECK(message.find('\n') == std::string::npos);
    for (const auto& part : fault.said) {
      INFO(part);
      CHECK(says(message, {part}));
    }
  }
}

TEST_CASE("the text of three messages") {
  CHECK(error_of(two_links(inertial("-1.5", 1, 1, 1))) ==
        "arm.urdf: link 'one': mass -1.5 kg is negative. Give a mass >= 0.");
  CHECK(error_of(two_links("<inertial><mass value=\"1\"/></inertial>")) ==
        "arm.urdf: link 'one': <inertial> cannot be read: Inertial element must have inertia element. "
        "Correct it; "
        "remove <inertial> only if the link has no mass.");
  const auto arm = load(two_links(inertial("1", 0.01, 0.01, 0.05)));
  REQUIRE(arm.warnings.size() == 1);
  CHECK(arm.warnings[0] ==
        "arm.urdf: link 'one': principal inertias (0.01, 0.01, 0.05) kg m^2 break the triangle inequality "
        "(0.05 > 0.02). No rigid body has these; check for a unit or about-point mistake.");
}

TEST_CASE("all faulty links are named at once") {
  const auto message = error_of(robot(a_link("base", "") + a_link("one", inertial("-1", 1, 1, 1)) +
                                      a_link("two", "<inertial><mass value=\"1\"/></inertial>") +
                                      a_joint("j1", "base", "one") + a_joint("j2", "one", "two")));
  CHECK(says(message, {"arm.urdf: link 'one': mass -1", "\narm.urdf: link 'two': <inertial>"}));
}

TEST_CASE("links that are no chain are errors") {
  const auto text = robot(a_link("base", "") + a_link("left") + a_link("right") + a_link("hand") +
                          a_joint("jl", "base", "left") + a_joint("jr", "base", "right") +
                          a_joint("jf", "right", "hand", "fixed", ""));
  CHECK(says(error_of(text, "rihgt"), {"tip link 'rihgt'", "Nearest names: 'right'"}));
  CHECK(says(error_of(text, "left", "bass"), {"base link 'bass'", "'base'"}));
  CHECK(says(error_of(text, "left", "right"),
             {"'left' does not descend from base link 'right'", "ancestors: 'base'"}));
  CHECK(says(error_of(text, "base", "right"), {"root of the tree"}));
  CHECK(says(error_of(text, "hand", "right"), {"no movable joint", "'right'", "'hand'"}));
  CHECK(says(error_of(text, "hand", "hand"), {"no movable joint"}));
  CHECK(says(error_of(text, ""), {"no tip link", "'left'", "'hand'"}));
}

TEST_CASE("what is legal but odd loads") {
  CHECK(load(two_links() + " and <some> text after it").chain.n() == 2);
  CHECK(load("\xEF\xBB\xBF" + two_links()).chain.n() == 2);  // byte order mark
  CHECK(load(robot("<sensor:x drake:y=\"1\"/>" + a_link("base", "") + a_link("two") +
                   a_joint("two", "base", "two")))
            .chain.n() == 1);
  const auto bad_picture = "<visual><geometry><box/></geometry></visual>" + ball;
  CHECK(load(two_links(bad_picture)).chain.links[0].mass == 1);
}

TEST_CASE("limits and dynamics are read; limits without room are ignored with a warning") {
  const auto arm = load(
      two_links(ball, "<limit effort=\"5\" velocity=\"2\"/><dynamics damping=\"0.5\" friction=\"0.25\"/>"));
  CHECK(arm.joints[0].lower == -1.0);
  CHECK(arm.joints[0].upper == 1.0);
  CHECK(arm.joints[0].effort == 5.0);
  CHECK(arm.joints[0].velocity == 2.0);
  CHECK_FALSE(arm.joints[1].lower);
  CHECK_FALSE(arm.joints[1].upper);
  CHECK(arm.joints[1].damping == 0.5);
  CHECK(arm.joints[1].friction == 0.25);
  REQUIRE(arm.warnings.size() == 1);
  CHECK(says(arm.warnings[0], {"joint 'j2'", "no room"}));
}

TEST_CASE("links without usable inertia are concerns, not errors") {
  CHECK(load(two_links("")).inertia_concerns ==
        std::vector<std::string>{"link 'one': no <inertial>, so no mass and no inertia"});
  CHECK(load(two_links(inertial("0", 0, 0, 0))).inertia_concerns ==
        std::vector<std::string>{"link 'one': mass 0 kg, inertia 0"});
  CHECK(load(two_links(inertial("2", 0, 0, 0))).inertia_concerns ==
        std::vector<std::string>{"link 'one': point mass of 2 kg, inertia 0"});
  const auto rotor = load(two_links(inertial("0", 0, 0, 0.35)));  // link 1 of the PUMA 560
  CHECK(rotor.inertia_concerns == std::vector<std::string>{"link 'one': mass 0 kg, inertia only"});
  CHECK(rotor.warnings.size() == 1);
  CHECK(rotor.chain.links[0].inertia(2, 2) == 0.35);
}

TEST_CASE("numbers read the same under a locale with a decimal comma, and messages keep the point") {
  const auto text = two_links(inertial("1234.5", 0.01, 0.01, 0.05));
  const auto expected = load(text);
  const GlobalLocale comma(std::locale(std::locale::classic(), new CommaDecimals));
  std::ostringstream shows;
  shows << 1234.5;
  REQUIRE(shows.str() == "1.234,5");
  const auto arm = load(text);
  CHECK(arm.chain.links[0].mass == 1234.5);
  CHECK(arm.chain.links[0].inertia == expected.chain.links[0].inertia);
  CHECK(arm.warnings == expected.warnings);
}

TEST_CASE("files that cannot be read are errors") {
  CHECK(says(error_of_file(data("missing.urdf")), {"missing.urdf: no such file"}));
  CHECK(says(error_of_file(data("")), {"is a directory"}));
  CHECK(says(error_of_file(data("truncated.urdf")), {"truncated.urdf: not a usable URDF file: Error"}));
  CHECK(says(error_of_file(data("utf16.urdf")), {"utf16.urdf: byte 3 is zero"}));
  CHECK(
      says(error_of_file(data("two_parents.urdf")), {"two_parents.urdf: link 'two' has two parent joints"}));
  const auto large =
      std::filesystem::temp_directory_path() / ("osculate_test_large_" + std::to_string(::getpid()));
  std::ofstream(large).close();
  std::filesystem::resize_file(large, (64u << 20) + 1);  // sparse
  CHECK(says(error_of_file(large), {"larger than 64 MB"}));
  std::filesystem::remove(large);
}

TEST_CASE("a file as real ones are loads: comments, foreign elements, text after the end") {
  ChainChoice choice;
  choice.tip = "two";
  const auto arm = load_urdf(data("untidy.urdf"), choice);
  CHECK(arm.source == data("untidy.urdf"));
  CHECK(arm.chain.n() == 2);
  CHECK(arm.chain.links[0].mass == 1);
  CHECK(arm.joints[1].continuous);
  CHECK_FALSE(arm.joints[1].lower);
  CHECK_FALSE(arm.joints[1].effort);
  CHECK(arm.urdf_text.find("trailing text") != std::string::npos);
}

TEST_CASE("nothing is printed, whatever urdfdom has to say") {
  std::fflush(nullptr);
  const auto log =
      std::filesystem::temp_directory_path() / ("osculate_test_log_" + std::to_string(::getpid()));
  const int file = ::open(log.c_str(), O_CREAT | O_WRONLY | O_TRUNC, 0600);
  const int out = ::dup(1), err = ::dup(2);
  ::dup2(file, 1);
  ::dup2(file, 2);
  const auto refused = error_of(two_links("<inertial/>", "<limit/>"));
  const auto odd = load(two_links("<visual><geometry><box/></geometry></visual>")).chain.n();
  std::fflush(nullptr);
  ::dup2(out, 1);
  ::dup2(err, 2);
  for (const int descriptor : {file, out, err}) ::close(descriptor);
  CHECK_FALSE(refused.empty());
  CHECK(odd == 2);
  CHECK(std::filesystem::file_size(log) == 0);
  std::filesystem::remove(log);
}

TEST_CASE("absurdly nested elements are refused before the XML library recurses into them") {
  std::string text;
  for (int i = 0; i < 200000; ++i) text += "<a>";
  CHECK(says(error_of(text), {"200000 deep", "at most 1000"}));
  std::string comments;
  for (int i = 0; i < 2000; ++i) comments += "<!-- <a> -->";
  CHECK(load(comments + two_links()).chain.n() == 2);
}

TEST_CASE("the listing of a file shows its tree and its problems") {
  const auto lines = list_urdf(data("negative_mass.urdf"));
  REQUIRE(lines.size() == 7);
  CHECK(lines[0] == "robot 'negative_mass': 3 links, 2 joints");
  CHECK(lines[1] == "link 'base': no <inertial>");
  CHECK(lines[2] == "  joint 'j1': revolute, axis (0, 0, 1), -1 to 1 rad, at most 2 rad/s, at most 5 N m");
  CHECK(lines[3] == "  link 'one': mass -1 kg, centre of mass (0, 0, 0.5) m");
  CHECK(lines[4] == "    joint 'j2': fixed");
  CHECK(lines[5] == "    link 'two': no <inertial>");
  CHECK(lines[6] == "problem: link 'one': mass -1 kg is negative. Give a mass >= 0.");
  CHECK_THROWS_AS(list_urdf(data("two_parents.urdf")), ModelError);
}

}  // namespace osculate::testing::faults_tests
