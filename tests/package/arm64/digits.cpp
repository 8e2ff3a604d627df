// Prints the sums of the identification's portable kernels to the last bit.
#include <cstddef>
#include <cstdio>
#include <vector>

#include "base/random.h"
#include "identification/kernels.h"

namespace {

using capsoc::identification::Kernels;

template <typename Sums>
void print(const char* name, const Sums& sums) {
  std::printf("%s", name);
  const auto* const values = reinterpret_cast<const double*>(&sums);
  for (std::size_t i = 0; i < sizeof sums / sizeof(double); ++i) std::printf(" %a", values[i]);
  std::printf("\n");
}

}  // namespace

int main() {
  const Kernels& kernels = capsoc::identification::kernels(capsoc::identification::Width::portable);
  capsoc::Random random(1);
  for (const std::size_t count : {1, 7, 8, 9, 100, 1003}) {
    std::vector<double> u(count), v(count);
    for (double& value : u) value = random.uniform() - 0.5;
    for (double& value : v) value = random.uniform() - 0.5;
    const capsoc::identification::FusedForm form{0.01, -0.02, 1.7, 1.4, 1.2, 0.3, 0.4, 0.9};
    print("gradient", kernels.gradient(u.data(), v.data(), count, form));
    print("normal", kernels.normal(u.data(), v.data(), count, form));
    print("moments", kernels.moments(u.data(), v.data(), count, 0.1, 0.2, 3, 4));
    print("extent", kernels.extent(u.data(), v.data(), count));
  }
  return 0;
}
