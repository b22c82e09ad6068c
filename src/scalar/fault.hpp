// Faults that a test build can seed, one at a time, by name. In the real build `seeded` is the identity and
// costs nothing: the compiler sees `return x`. The test build (OSCULATE_FAULTS) negates the value that passes
// the named place.
#pragma once

#include <array>
#include <string_view>

namespace osculate {

/// Every place where a fault can be seeded. Names are the enumerators as printed in `fault_names`.
enum class Fault {
  none,
  spatial_cross,         // the vector product under every shift and bias term
  spatial_turn,          // rotation of an inertia into the base frame
  shift_force,           // phi f
  shift_motion,          // phi* V
  shift_inertia,         // phi P phi*
  shift_compliance,      // phi* Omega phi
  strip_inertia,         // (1 - G H) P (1 - G H)*
  strip_compliance,      // (1 - G H)* Omega (1 - G H)
  velocity_joint,        // (41) H* thd
  bias_acceleration,     // (48)
  bias_force,            // (47)
  tip_bias,              // a(0)
  articulated_mass,      // (37) + M(k)
  articulated_armature,  // (37) + K J K*
  articulated_force,     // (66) + b(k)
  innovation_bias,       // (66) - a(k)
  compliance_joint,      // (58) + H* D^-1 H
  compliance_bias,       // (67) + xi(k)
  tip_right_side,        // (68) - a(0)
  tip_gravity,           // section 4.3, corrected: + a_g at the tip
  gravity_tip,           // (74)
  torque_shift,          // (39)
  plant_acceleration,    // forward dynamics, base to tip
  plant_joint,           // forward dynamics: H* thdd
  law_command,           // u in (4)
};

inline constexpr std::array fault_names = {
    std::string_view{"none"},
    std::string_view{"spatial_cross"},
    std::string_view{"spatial_turn"},
    std::string_view{"shift_force"},
    std::string_view{"shift_motion"},
    std::string_view{"shift_inertia"},
    std::string_view{"shift_compliance"},
    std::string_view{"strip_inertia"},
    std::string_view{"strip_compliance"},
    std::string_view{"velocity_joint"},
    std::string_view{"bias_acceleration"},
    std::string_view{"bias_force"},
    std::string_view{"tip_bias"},
    std::string_view{"articulated_mass"},
    std::string_view{"articulated_armature"},
    std::string_view{"articulated_force"},
    std::string_view{"innovation_bias"},
    std::string_view{"compliance_joint"},
    std::string_view{"compliance_bias"},
    std::string_view{"tip_right_side"},
    std::string_view{"tip_gravity"},
    std::string_view{"gravity_tip"},
    std::string_view{"torque_shift"},
    std::string_view{"plant_acceleration"},
    std::string_view{"plant_joint"},
    std::string_view{"law_command"},
};
static_assert(fault_names.size() == static_cast<std::size_t>(Fault::law_command) + 1);

#ifdef OSCULATE_FAULTS
inline Fault active_fault = Fault::none;  // test build only: the one global of the program

/// -x where the named fault is active, x elsewhere.
template <class T>
T seeded(Fault where, const T& x) {
  return where == active_fault ? T(-x) : x;
}
#else
template <class T>
constexpr const T& seeded(Fault, const T& x) {
  return x;
}
#endif

}  // namespace osculate
