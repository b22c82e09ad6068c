#include "reference/exact.hpp"

namespace osculate::dense {

OSCULATE_EXACT(, Rational);
OSCULATE_OPERATORS(, Rational);

}  // namespace osculate::dense
