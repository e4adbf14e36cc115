#include "settings/address_write.hpp"

#include <algorithm>
#include <utility>

#include "base/format.hpp"
#include "drive/naming.hpp"
#include "session/option_scope.hpp"
#include "session/write.hpp"
#include "settings/restore_end.hpp"

namespace servoctl::settings {
namespace {

class AddressWriting {
 public:
  AddressWriting(show::Desk& desk, const AddressChange& change, const AddressOptions& options,
                 AddressOutcome& out)
      : desk_(&desk), session_(desk.session), change_(&change), options_(&options), out_(&out) {}

  /// What is begun is brought to its end, whoever is impatient.
  bool write() {
    const session::Deaf deaf(*session_);
    session::StorageScope storage(*session_, desk_->profile, change_->node);
    const bool keeps = session::can_store(*desk_->profile);
    if (const auto opened = storage.open(keeps, options_->unlock, true); !opened)
      return fail_with(AddressEnd::as_before, opened.error());
    const bool in_ram = storage.worked_in_ram();
    const auto written = session::write_all(*session_, change_->writes, true);
    const auto wrong = std::find_if(written.begin(), written.end(), [](const auto& w) { return !w; });
    const bool all = wrong == written.end();
    const auto back = all ? Result<void>() : put_back(written);
    const auto done =
        std::count_if(written.begin(), written.end(), [](const auto& w) { return w.has_value(); });
    const auto kept = storage.close(all, static_cast<std::size_t>(done));
    for (const auto& notice : storage.notices()) desk_->notices.push_back(notice);
    if (!all)
      return not_written(wrong->error(),
                         change_->writes[static_cast<std::size_t>(wrong - written.begin())].object, back,
                         in_ram ? doubtful(written) : std::vector<ObjectAddress>());
    if (!kept) return not_kept(kept.error());
    out_->kept = *kept;
    return true;
  }

 private:
  bool fail_with(AddressEnd end, Error error) {
    out_->end = end;
    out_->error = std::move(error);
    return false;
  }

  /// A write that was refused has changed nothing; any other may have been done.
  Result<void> put_back(std::span<const Result<session::Written>> written) {
    Result<void> out;
    for (std::size_t i = 0; i < written.size(); ++i) {
      if (!written[i] && written[i].error().code == Errc::sdo_abort) continue;
      const session::SdoRequest back[] = {{change_->node, change_->writes[i].object, change_->before[i]}};
      const auto done = session::write_all(*session_, back, true).front();
      if (!done) out = fail(done.error());
    }
    return out;
  }

  /// What a drive that worked in its RAM got back into its flash, which may have held another value: but it
  /// has its node-ID from there.
  std::vector<ObjectAddress> doubtful(std::span<const Result<session::Written>> written) const {
    const auto node_id = drive::place_of(*desk_->profile, desk_->profile->rules.nmt.node_id);
    std::vector<ObjectAddress> out;
    for (std::size_t i = 0; i < written.size(); ++i) {
      const auto object = change_->writes[i].object;
      const bool refused = !written[i] && written[i].error().code == Errc::sdo_abort;
      const bool known = object == node_id && load_le(change_->before[i]) == change_->node;
      if (!refused && !known) out.push_back(object);
    }
    return out;
  }

  bool not_written(Error error, ObjectAddress object, const Result<void>& back,
                   const std::vector<ObjectAddress>& in_flash) {
    const auto& store = desk_->profile->rules.store;
    if (error.code == Errc::sdo_abort && !store.unlock.empty() && !options_->unlock)
      error.hint = message("it may be locked by {}: add --unlock", store.unlock);
    if (back && in_flash.empty()) return fail_with(AddressEnd::as_before, std::move(error));
    if (back) {
      const auto flash = flash_error(desk_->profile, change_->node, in_flash);
      error.message += "; " + flash.message;
      error.hint = flash.hint;
      return fail_with(AddressEnd::failed, std::move(error));
    }
    error.message += "; what it holds now is not known: " + back.error().message;
    error.hint = message("before it is switched off: `read {} -n {}`, which holds from its next start on",
                         as_it_is(to_string(object)), node_name(change_->node));
    return fail_with(AddressEnd::failed, std::move(error));
  }

  bool store_again() {
    session::StorageScope storage(*session_, desk_->profile, change_->node);
    return storage.open(true, options_->unlock, true) && storage.close(true, 0);
  }

  /// An address that is written and not kept would come and go with the power.
  bool not_kept(Error error) {
    const std::vector<Result<session::Written>> written(change_->writes.size(), session::Written{});
    const auto back = put_back(written);
    // It may have stored all the same, and only its answer was lost.
    const bool may_hold = error.code != Errc::sdo_abort;
    error.message = "the address was written and could not be kept: " + error.message;
    if (back && (!may_hold || store_again())) {
      error.message += "; the old one was written back";
      return fail_with(AddressEnd::as_before, std::move(error));
    }
    if (back) {
      error.message +=
          "; the old one was written back, and could not be stored either: which of them it has after "
          "power-off is not known";
      error.hint =
          message("`store -n {}` before it is switched off stores the old one", node_name(change_->node));
      return fail_with(AddressEnd::failed, std::move(error));
    }
    error.message += "; and writing the old one back failed: " + back.error().message;
    return fail_with(AddressEnd::failed, std::move(error));
  }

  show::Desk* desk_;
  session::Session* session_;
  const AddressChange* change_;
  const AddressOptions* options_;
  AddressOutcome* out_;
};

}  // namespace

bool write_address(show::Desk& desk, const AddressChange& change, const AddressOptions& options,
                   AddressOutcome& out) {
  return AddressWriting(desk, change, options, out).write();
}

}  // namespace servoctl::settings
