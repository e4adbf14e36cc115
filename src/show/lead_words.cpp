#include "show/lead_words.hpp"

#include <array>

#include "base/folded.hpp"
#include "base/text.hpp"

namespace servoctl::show {
namespace {

struct Lead {
  std::string_view words;
  Found found;
};

/// The longer ones first.
constexpr std::array kLeads{
    Lead{"sdo abort code", Found::abort}, Lead{"abort code", Found::abort}, Lead{"sdo abort", Found::abort},
    Lead{"abort", Found::abort},          Lead{"sdo 中止码", Found::abort}, Lead{"sdo中止码", Found::abort},
    Lead{"中止代码", Found::abort},       Lead{"中止码", Found::abort},     Lead{"emergency", Found::fault},
    Lead{"emcy", Found::fault},           Lead{"error code", Found::fault}, Lead{"fault code", Found::fault},
    Lead{"alarm code", Found::fault},     Lead{"error", Found::fault},      Lead{"fault", Found::fault},
    Lead{"alarm", Found::fault},          Lead{"紧急报文", Found::fault},   Lead{"故障代码", Found::fault},
    Lead{"故障码", Found::fault},         Lead{"错误代码", Found::fault},   Lead{"错误码", Found::fault},
    Lead{"报警代码", Found::fault},       Lead{"报警码", Found::fault},     Lead{"故障", Found::fault},
    Lead{"报警", Found::fault},           Lead{"object", Found::object},    Lead{"对象", Found::object},
    Lead{"parameter", Found::parameter},  Lead{"参数", Found::parameter}};

}  // namespace

std::optional<Led> without_lead(std::string_view text) {
  const auto typed = folded(text);
  for (const auto& lead : kLeads) {
    if (!typed.starts_with(lead.words)) continue;
    auto rest = std::string_view(typed).substr(lead.words.size());
    const bool is_ascii = static_cast<unsigned char>(lead.words.back()) < 0x80;
    // `aborted` is another word; between Chinese and a number there need be no blank.
    if (is_ascii && !rest.starts_with(' ') && !rest.starts_with(':')) continue;
    if (rest.starts_with(':')) rest.remove_prefix(1);
    if (rest = trim(rest); !rest.empty()) return Led{lead.found, std::string(rest)};
  }
  return std::nullopt;
}

}  // namespace servoctl::show
