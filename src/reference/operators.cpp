#include "reference/operators.hpp"

namespace osculate::dense {

OSCULATE_OPERATORS(, double);

}  // namespace osculate::dense
