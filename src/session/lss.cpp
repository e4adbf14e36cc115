#include "session/lss.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "base/format.hpp"
#include "session/can_network.hpp"
#include "session/hearing.hpp"
#include "session/option_scope.hpp"

namespace servoctl::session {
namespace {

using canopen::LssAddress;
using canopen::LssService;
using canopen::LssState;

/// Slaves in the configuration state answer at once; that none is there any more is asked only for so long.
constexpr Duration kLeaveCheck = std::chrono::milliseconds(50);
constexpr int kLeaveTries = 3;
constexpr Duration kLinkPatience = std::chrono::seconds(1);

constexpr LssService kLssNumbers[] = {LssService::inquire_vendor, LssService::inquire_product,
                                      LssService::inquire_revision, LssService::inquire_serial};

std::string who(const std::optional<LssAddress>& address) {
  return address ? formatted("the LSS slave with {}", to_string(*address)) : "an LSS slave";
}

tl::unexpected<Error> nobody(const std::optional<LssAddress>& address) {
  return fail(Errc::timeout,
              address ? message("no LSS slave answers to {}", to_string(*address))
                      : std::string("no LSS slave answers on this bus"),
              "`lss scan` finds those without a node-ID; many drives have no LSS, or have it switched off: "
              "`help address` tells how their own parameter is written");
}

tl::unexpected<Error> several(const std::optional<LssAddress>& address, std::size_t count) {
  return address ? fail(Errc::refused, message("{} LSS slaves have {}", count, to_string(*address)),
                        "nothing was set; switch all but one of them off, and take one after the other")
                 : fail(Errc::refused, message("{} LSS slaves answer: --only takes one that is alone", count),
                        "nothing was set; name the one that is meant by --vendor, --product, --revision and "
                        "--serial, or switch the others off");
}

}  // namespace

void LssDialogue::touch() {
  if (std::exchange(touched_, true)) return;
  hold_ = session_->protect(Care::guarded);
}

Result<LssDialogue::Answers> LssDialogue::ask(const canopen::LssRequest& request, Pace pace) {
  touch();
  canopen::LssMaster master({.patience = pace.patience, .further = pace.further});
  const Hearing hearing(*session_, [&](const can::Frame& frame, TimePoint time) {
    foreign_ = foreign_ || (frame.id == canopen::kLssRequest && !frame.extended && !frame.error);
    master.on_frame(frame, time);
  });
  master.start(request, session_->now());
  for (;;) {
    while (const auto frame = master.take_frame()) {
      if (const auto sent = session_->can()->send(*frame); !sent) return fail(sent.error());
      master.on_time(session_->now());
    }
    if (foreign_)
      return fail(Errc::refused, "another LSS master is at work on this bus",
                  "its requests and answers cannot be told from ours: end it, and begin again");
    if (auto result = master.take_result()) return std::move(*result);
    if (const auto stepped = session_->step(master.deadline()); !stepped) return fail(stepped.error());
    master.on_time(session_->now());
  }
}

Result<void> LssDialogue::send_to_waiting() {
  const auto sent = ask(canopen::lss_switch_all(LssState::waiting));
  return sent ? Result<void>() : fail(sent.error());
}

Result<void> LssDialogue::select_all() {
  const auto sent = ask(canopen::lss_switch_all(LssState::configuration));
  return sent ? Result<void>() : fail(sent.error());
}

Result<LssSlave> LssDialogue::select(const std::optional<LssAddress>& address) {
  if (const auto sent = send_to_waiting(); !sent) return fail(sent.error());
  if (!address) {
    if (const auto sent = select_all(); !sent) return fail(sent.error());
    return look(address);
  }
  const auto answers = ask(canopen::lss_select(*address));
  if (!answers) return fail(answers.error());
  if (answers->empty()) return nobody(address);
  if (answers->size() > 1) return several(address, answers->size());
  return look(address);
}

/// Whoever does not say a number is taken at the word that selected it; without that word it has to say them
/// all.
Result<LssSlave> LssDialogue::look(const std::optional<LssAddress>& address) {
  LssSlave out;
  out.address = address.value_or(LssAddress{});
  std::uint32_t* const parts[] = {&out.address.vendor, &out.address.product, &out.address.revision,
                                  &out.address.serial};
  const auto node = ask(canopen::lss_inquire(LssService::inquire_node));
  if (!node) return fail(node.error());
  if (node->size() > 1) return several(address, node->size());
  if (!node->empty()) out.node = static_cast<std::uint8_t>(node->front().number);
  bool silent = node->empty();
  for (std::size_t i = 0; i < std::size(kLssNumbers); ++i) {
    const auto number = ask(canopen::lss_inquire(kLssNumbers[i]));
    if (!number) return fail(number.error());
    if (number->size() > 1) return several(address, number->size());
    if (number->empty()) {
      if (address) continue;
      if (silent && i == 0) return nobody(address);
      return fail(Errc::timeout, "the LSS slave does not tell its whole identity",
                  "name it by --vendor, --product, --revision and --serial, as it stands on its label");
    }
    silent = false;
    if (address && number->front().number != *parts[i])
      return fail(Errc::protocol,
                  message("{} says of itself 0x{:08X} where 0x{:08X} was selected", who(address),
                          number->front().number, *parts[i]),
                  "nothing was set; is another slave in the configuration state?");
    *parts[i] = number->front().number;
  }
  return out;
}

Result<void> LssDialogue::order(const canopen::LssRequest& request, std::string_view what,
                                Duration patience) {
  const auto answers = ask(request, patience);
  if (!answers) return fail(answers.error());
  if (answers->empty())
    return fail(Errc::timeout, message("the LSS slave did not say whether it has {}", what),
                "one that does not support a request may leave it unanswered; --timeout waits longer");
  const auto refusal =
      std::find_if(answers->begin(), answers->end(), [](const auto& answer) { return answer.error != 0; });
  if (refusal != answers->end())
    return fail(Errc::negative,
                message("the LSS slave has not {}: {}", what, canopen::lss_error_text(*refusal)),
                "CiA 305 leaves it to the maker what a slave supports: its manual says");
  if (answers->size() > 1)
    return fail(Errc::refused, message("{} LSS slaves said that they have {}", answers->size(), what),
                "switch all but one off, and look at each with `lss inquire --only`");
  return {};
}

Result<void> LssDialogue::leave() {
  if (!touched_) return {};
  const Deaf deaf(*session_);
  Result<void> out;
  for (int i = 0; i < kLeaveTries; ++i) {
    foreign_ = false;
    out = send_to_waiting();
    if (!out && out.error().code == Errc::bus)
      (void)session_->network().recover(session_->now() + kLinkPatience);
    if (!out) continue;
    const auto left = ask(canopen::lss_inquire(LssService::inquire_node), kLeaveCheck);
    if (left && left->empty()) break;
    out = left ? fail(Errc::negative, "an LSS slave stays in the configuration state",
                      "switch it off and on: until then it takes whatever any LSS master sets")
               : fail(left.error());
  }
  if (!out && out.error().code != Errc::negative)
    out.error().hint =
        "LSS slaves may still be in the configuration state: any `lss` command takes them out of it";
  touched_ = false;
  hold_.release();
  return out;
}

}  // namespace servoctl::session
