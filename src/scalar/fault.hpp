// Faults that a test build can seed, one at a time, by name. In the real build `seeded` is the identity and
// `faulty` is false, so they cost nothing. In the test build (OSCULATE_FAULTS) `seeded` negates the value
// that passes the named place, `faulty` chooses the wrong line, and both count how often they did.
#pragma once

#include <array>
#include <string_view>

namespace osculate {

/// Every place where a fault can be seeded, and what is wrong there; where only a term is named, its sign is.
enum class Fault {
  none,
  // spatial types
  spatial_cross,            // the vector product under every shift and bias term
  spatial_turn,             // rotation of an inertia into the base frame
  shift_force,              // phi f
  shift_motion,             // phi* V
  shift_inertia,            // phi P phi*
  shift_compliance,         // phi* Omega phi
  frame_force,              // phi f between link frames: the force half
  frame_motion,             // phi* V between link frames: the linear half
  strip_inertia,            // (1 - G H) P (1 - G H)*
  strip_compliance,         // (1 - G H)* Omega (1 - G H)
  psi_order,                // psi f as (1 - G H) phi f
  psi_star_order,           // psi* V as phi* (1 - G H)* V
  composite_inertia,        // phi P phi* for psi P psi*
  compliance_not_stripped,  // phi* Omega phi for psi* Omega psi
  joint_block,              // off-diagonal entries of D(k), joints with more axes
  joint_strip_inertia,      // (1 - G H) P (1 - G H)*, joints with more axes
  joint_strip_compliance,   // (1 - G H)* Omega (1 - G H), joints with more axes
  // placing the arm
  sense_of_rotation,        // s C in R_origin Rot(axis): turns the wrong way
  slide,                    // displacement of a prismatic joint
  inertia_about_com,        // I(k) about the centre of mass, not about O(k)
  inertia_turned_back,      // R^T I R for R I R^T
  first_moment_not_turned,  // m p left in link axes
  tip_not_turned,           // l(1,0) left in link axes
  gravity_sign,             // a_g
  base_acceleration,        // Vdot(n+1) of a moving base
  planar_axes,              // second direction of a planar joint
  spherical_axes,           // H of a spherical or floating joint in the joint's axes, not the link's
  // sweep 1
  velocity_joint,     // (41) H* thd
  bias_acceleration,  // (48)
  bias_turn,          // (48): w(k+1) x w(k) as w(k) x w(k+1)
  outer_rate,         // (48): w(k) for w(k+1) in w x (w x l)
  coriolis_once,      // (48), sliding joints: w x v for 2 w x v
  bias_force,         // (47)
  gyroscopic,         // (47): w x I w
  centrifugal,        // (47): m w x (w x p)
  inner_velocity,     // (47): V(k+1) for V(k)
  tip_bias,           // a(0)
  // sweep 2
  articulated_mass,       // (37) + M(k)
  articulated_armature,   // (37) + K J K*
  armature_without_gain,  // (37) without K J K*, as printed
  stale_gain,             // (33) psi(k+1,k) with G(k-1)
  known_torque,           // (66) + K T0
  bias_inertia,           // (66) + P(k) a(k)
  articulated_force,      // (66) + b(k)
  innovation,             // (66) H z
  innovation_bias,        // (66) - a(k)
  tip_wrench,             // z(0) = -F_ext
  ground_in_every_link,   // section 4.3: A added to every a(k), not to a(n) alone
  // sweep 3 and gravity
  compliance_joint,  // (58) + H* D^-1 H
  compliance_bias,   // (67) + xi(k)
  tip_right_side,    // (68) - a(0)
  tip_gravity,       // section 4.3, corrected: + a_g at the tip
  printed_4_3,       // section 4.3 as printed: no a_g at the tip
  gravity_tip,       // (74)
  gravity_start,     // (73) eta(n+1) = a_g
  // sweep 4
  torque_shift,       // (39)
  torque_next_shift,  // (39): phi(k+1,k) for phi(k,k-1)
  null_space_torque,  // T = J* F + T0
  // delayed forms
  velocity_too_old,       // a, b of two samples ago
  extrapolated_velocity,  // 2 x(-1) - x(-2) for a, b
  force_too_old,          // F_c of two samples ago
  extrapolated_force,     // 2 x(-1) - x(-2) for F_c
  sampled_wrench,         // known wrench on the tip, sampled laws
  // plant
  plant_innovation,    // (51): T - H z
  plant_acceleration,  // (51): G* alpha
  plant_joint,         // H* thdd
  plant_bias,          // + a(k)
  plant_tip_bias,      // (8): + a(0)
  plant_wrench,        // wrench on the tip
  plant_friction,      // joint friction
  contact_normal,      // normal force of a surface on the tip
  contact_damping,     // damping of a surface
  contact_friction,    // friction of a surface
  rotor_energy,        // kinetic energy of the rotors
  weight,              // potential energy of a link
  work,                // work of the joint torques
  // laws
  law_command,             // u in (4)
  force_feedback,          // measured force in u
  law_rows,                // the last two task rows change places
  reference_acceleration,  // acceleration of the reference in u
  law_damping,             // D ed in u
  friction_compensation,   // joint friction added to the torque
  resolved_bias,           // resolved acceleration: - Jdot qd
  resolved_force,          // resolved acceleration: M alpha + b
  resolved_armature,       // resolved acceleration: armature
  coordinate_rate,         // Pidot ydot in u = Pi v + Pidot ydot
  coordinate_map,          // Pi v in u = Pi v + Pidot ydot
  tracking_damping,        // D (yd_ref - yd) in v
  tracking_reference,      // ydd_ref in v
};

/// Names of the enumerators, in order.
inline constexpr std::array fault_names = {
    std::string_view{"none"},
    std::string_view{"spatial_cross"},
    std::string_view{"spatial_turn"},
    std::string_view{"shift_force"},
    std::string_view{"shift_motion"},
    std::string_view{"shift_inertia"},
    std::string_view{"shift_compliance"},
    std::string_view{"frame_force"},
    std::string_view{"frame_motion"},
    std::string_view{"strip_inertia"},
    std::string_view{"strip_compliance"},
    std::string_view{"psi_order"},
    std::string_view{"psi_star_order"},
    std::string_view{"composite_inertia"},
    std::string_view{"compliance_not_stripped"},
    std::string_view{"joint_block"},
    std::string_view{"joint_strip_inertia"},
    std::string_view{"joint_strip_compliance"},
    std::string_view{"sense_of_rotation"},
    std::string_view{"slide"},
    std::string_view{"inertia_about_com"},
    std::string_view{"inertia_turned_back"},
    std::string_view{"first_moment_not_turned"},
    std::string_view{"tip_not_turned"},
    std::string_view{"gravity_sign"},
    std::string_view{"base_acceleration"},
    std::string_view{"planar_axes"},
    std::string_view{"spherical_axes"},
    std::string_view{"velocity_joint"},
    std::string_view{"bias_acceleration"},
    std::string_view{"bias_turn"},
    std::string_view{"outer_rate"},
    std::string_view{"coriolis_once"},
    std::string_view{"bias_force"},
    std::string_view{"gyroscopic"},
    std::string_view{"centrifugal"},
    std::string_view{"inner_velocity"},
    std::string_view{"tip_bias"},
    std::string_view{"articulated_mass"},
    std::string_view{"articulated_armature"},
    std::string_view{"armature_without_gain"},
    std::string_view{"stale_gain"},
    std::string_view{"known_torque"},
    std::string_view{"bias_inertia"},
    std::string_view{"articulated_force"},
    std::string_view{"innovation"},
    std::string_view{"innovation_bias"},
    std::string_view{"tip_wrench"},
    std::string_view{"ground_in_every_link"},
    std::string_view{"compliance_joint"},
    std::string_view{"compliance_bias"},
    std::string_view{"tip_right_side"},
    std::string_view{"tip_gravity"},
    std::string_view{"printed_4_3"},
    std::string_view{"gravity_tip"},
    std::string_view{"gravity_start"},
    std::string_view{"torque_shift"},
    std::string_view{"torque_next_shift"},
    std::string_view{"null_space_torque"},
    std::string_view{"velocity_too_old"},
    std::string_view{"extrapolated_velocity"},
    std::string_view{"force_too_old"},
    std::string_view{"extrapolated_force"},
    std::string_view{"sampled_wrench"},
    std::string_view{"plant_innovation"},
    std::string_view{"plant_acceleration"},
    std::string_view{"plant_joint"},
    std::string_view{"plant_bias"},
    std::string_view{"plant_tip_bias"},
    std::string_view{"plant_wrench"},
    std::string_view{"plant_friction"},
    std::string_view{"contact_normal"},
    std::string_view{"contact_damping"},
    std::string_view{"contact_friction"},
    std::string_view{"rotor_energy"},
    std::string_view{"weight"},
    std::string_view{"work"},
    std::string_view{"law_command"},
    std::string_view{"force_feedback"},
    std::string_view{"law_rows"},
    std::string_view{"reference_acceleration"},
    std::string_view{"law_damping"},
    std::string_view{"friction_compensation"},
    std::string_view{"resolved_bias"},
    std::string_view{"resolved_force"},
    std::string_view{"resolved_armature"},
    std::string_view{"coordinate_rate"},
    std::string_view{"coordinate_map"},
    std::string_view{"tracking_damping"},
    std::string_view{"tracking_reference"},
};
static_assert(fault_names.size() == static_cast<std::size_t>(Fault::tracking_reference) + 1);

#ifdef OSCULATE_FAULTS
// The only globals of the program, in the test build alone.
inline Fault active_fault = Fault::none;
inline long fault_executions = 0;

/// True where the named fault is active.
inline bool faulty(Fault where) {
  if (where != active_fault) return false;
  ++fault_executions;
  return true;
}
/// -x where the named fault is active, x elsewhere.
template <class T>
T seeded(Fault where, const T& x) {
  return faulty(where) ? T(-x) : x;
}
#else
constexpr bool faulty(Fault) { return false; }
template <class T>
constexpr const T& seeded(Fault, const T& x) {
  return x;
}
#endif

}  // namespace osculate
