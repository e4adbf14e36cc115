#include "show/provenance_record.hpp"

#include "show/records.hpp"

namespace servoctl::show {

report::Record provenance_record(const drive::Provenance& provenance) {
  report::List drives;
  for (const auto& drive : provenance.drives)
    drives.emplace_back(
        report::Record{{"model", drive.model}, {"firmware", drive.firmware}, {"date", drive.date}});
  return {{"manual", report::text_or_null(provenance.manual)},
          {"manual_zh", report::text_or_null(provenance.manual_zh)},
          {"simulator", provenance.simulator},
          {"drives", std::move(drives)}};
}

}  // namespace servoctl::show
