#include "reference/dense.hpp"

namespace osculate::dense {

OSCULATE_DENSE();

}  // namespace osculate::dense
