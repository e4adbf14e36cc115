#include "show/desk.hpp"

#include "report/chinese_value.hpp"

namespace servoctl::show {

Result<void> Desk::confirm(std::string_view question) const {
  return audience != nullptr ? audience->confirm(question) : Audience().confirm(question);
}

void Desk::emit(const report::Record& sample, std::string_view line) const {
  if (audience != nullptr) audience->emit(sample, line);
}

void Desk::write(std::string_view lines) const {
  if (audience != nullptr) audience->write(lines);
}

void Desk::tell(std::string_view text) const {
  if (audience != nullptr) audience->tell(text);
}

void Desk::show_progress(std::string_view line) const {
  if (audience != nullptr && session != nullptr) audience->show_progress(line, session->now());
}

void Desk::show_share(double share, TimePoint begin, TimePoint now) const {
  if (audience != nullptr) audience->show_share(share, begin, now);
}

void Desk::tell_value(const report::Value& value) const {
  if (audience != nullptr)
    audience->tell(report::to_text(chinese ? report::chinese_value(value) : value, audience->width()));
}

std::unique_ptr<LiveView> Desk::open_view(const LiveView::Layout& layout) const {
  return audience == nullptr ? nullptr : audience->open_view(layout);
}

}  // namespace servoctl::show
