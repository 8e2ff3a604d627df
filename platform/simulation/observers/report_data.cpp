#include "observers/report_data.h"

namespace capsoc::run {

std::optional<Error> ReportGatherer::open() {
  drawing_ =
      samples_.listen([this](const metrics::RecordedSample& sample) { curves_.add(sample); });
  text_.listen(uart_);
  return std::nullopt;
}

void ReportGatherer::visit_gathered(Archive& archive) {
  archive("curves", curves_);
  archive("text", text_);
}

void ReportGatherer::finish(RunResult& result) {
  result.report = ReportData{curves_.curves(result.words), text_.text(), text_.left_out()};
}

}  // namespace capsoc::run
