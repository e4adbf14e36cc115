#include "show/audience.hpp"

namespace servoctl::show {

Result<void> Audience::confirm(std::string_view question) {
  return fail(Errc::refused, "nobody is there to confirm: " + std::string(question));
}

void Audience::emit(const report::Record& /*sample*/, std::string_view /*line*/) {}
void Audience::write(std::string_view /*lines*/) {}
void Audience::tell(std::string_view /*text*/) {}
void Audience::show_progress(std::string_view /*line*/, TimePoint /*now*/) {}
void Audience::show_share(double /*share*/, TimePoint /*begin*/, TimePoint /*now*/) {}

std::unique_ptr<LiveView> Audience::open_view(const LiveView::Layout& /*layout*/) { return nullptr; }

}  // namespace servoctl::show
