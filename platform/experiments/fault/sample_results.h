// What the coprocessor made of each sample, while a simulation lasts.
#pragma once

#include <functional>

#include "fault/verdict.h"
#include "kit/probe.h"
#include "session/simulation.h"

namespace capsoc::fault {

class SampleResults {
 public:
  using Take = std::function<void(const SampleResult& result)>;

  SampleResults(run::Simulation& simulation, Take take)
      : listening_(simulation.observation().samples.listen(
            [take = std::move(take)](const metrics::RecordedSample& sample) {
              SampleResult result;
              result.number = sample.number;
              result.exists = sample.result.has_value();
              if (result.exists) {
                result.angle = sample.result->angle;
                result.status = sample.result->status;
                result.flags = sample.result->flags;
                result.has_angle = sample.result->angle_valid;
              }
              take(result);
            })) {}

 private:
  kit::Listening listening_;
};

}  // namespace capsoc::fault
