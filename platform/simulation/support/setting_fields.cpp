#include "support/setting_fields.h"

#include <cmath>

#include "support/number.h"

namespace capsoc {

double NumberField::operator()() const {
  return finite_number(text()).value_or(0);
}

long long IntegerField::operator()() const {
  return std::llround(finite_number(text()).value_or(0));
}

}  // namespace capsoc
