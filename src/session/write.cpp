#include "session/write.hpp"

#include "base/format.hpp"

namespace servoctl::session {
namespace {

Error about(const SdoRequest& request, Errc code, Message what, Message hint) {
  return drive_error(code, request.node, request.object, what, std::move(hint));
}

/// Bytes in a message: all of a short value, the beginning of a long one.
std::string shown(ByteSpan data) {
  constexpr std::size_t kMost = 32;
  if (data.size() <= kMost) return to_hex(data);
  return formatted("{} … ({} bytes)", to_hex(data.first(kMost)), data.size());
}

/// Whether it is unknown what became of the write: no answer, or one that is none. A request that was not
/// tried carries the object that failed before it.
bool answer_lost(const Error& error, ObjectAddress object) {
  return (error.code == Errc::timeout || error.code == Errc::protocol) && error.object == object;
}

Result<Written> after_lost_answer(const SdoRequest& request, const Error& lost, const Result<Bytes>& found) {
  const std::string_view what = lost.code == Errc::timeout ? "the write was sent, but no answer came"
                                                           : "the write was sent, its answer was invalid";
  if (!found)
    return fail(about(request, lost.code, message("{}, and the value cannot be read back", what),
                      "whether the value was written is unknown: read it when the node answers again"));
  if (*found != *request.data)
    return fail(about(request, Errc::negative,
                      message("{}, and it had no effect: the object holds {}", what, shown(*found)),
                      "write it again"));
  Written done;
  done.answer_lost = true;
  done.read_back = *found;
  return done;
}

/// Of this write, which may have been done.
Error open_end(const SdoRequest& request, Error error) {
  error.may_be_done = true;
  if (!error.node) error.node = request.node;
  if (!error.object) error.object = request.object;
  return error;
}

Result<Written> after_transfer(const SdoRequest& request, const Result<Bytes>& answer) {
  if (answer) return Written{};
  const auto code = answer.error().code;
  if (code != Errc::bus && code != Errc::interrupted) return fail(answer.error());
  // It may have been under way; or it waited for its turn.
  auto error = open_end(request, answer.error());
  error.message += "; whether the value was written is not known";
  return fail(std::move(error));
}

Result<Written> after_answer(const SdoRequest& request, const Result<Bytes>& found) {
  if (!found) {
    auto error = open_end(request, found.error());
    error.message = "written, but reading it back failed: " + error.message;
    return fail(std::move(error));
  }
  if (*found != *request.data)
    return fail(about(request, Errc::negative,
                      message("the drive acknowledged {} but holds {}", shown(*request.data), shown(*found)),
                      "the drive limits or rounds the value, or another setting overrides it"));
  Written done;
  done.read_back = *found;
  return done;
}

}  // namespace

WriteEnd write_end(const Result<Written>& written, ObjectAddress object) {
  if (written) return WriteEnd::written;
  if (answer_lost(written.error(), object)) return WriteEnd::unknown;
  if (written.error().may_be_done) return WriteEnd::unknown;
  // The line was cut, or Ctrl-C came: it may have been under way.
  if (written.error().code == Errc::bus || written.error().code == Errc::interrupted)
    return WriteEnd::unknown;
  return written.error().code == Errc::negative ? WriteEnd::other_value : WriteEnd::not_written;
}

std::string_view state_text(const Result<Written>& written, ObjectAddress object) {
  switch (write_end(written, object)) {
    case WriteEnd::not_written: return "not written";
    case WriteEnd::other_value: return "holds another value";
    case WriteEnd::unknown: return "not known";
    case WriteEnd::written: break;
  }
  if (written->answer_lost) return "written (the answer was lost, the value was read back)";
  return written->read_back ? "written, read back" : "written";
}

std::vector<Result<Written>> write_all(Session& session, std::span<const SdoRequest> requests,
                                       bool read_back) {
  const auto answers = session.transfer(requests);
  std::vector<Result<Written>> out;
  std::vector<SdoRequest> questions;
  std::vector<std::size_t> asked;
  for (std::size_t i = 0; i < requests.size(); ++i) {
    out.push_back(after_transfer(requests[i], answers[i]));
    const bool lost = !answers[i] && answer_lost(answers[i].error(), requests[i].object);
    if (!lost && !(answers[i] && read_back)) continue;
    questions.push_back(
        {requests[i].node, requests[i].object, {}, requests[i].transfer, requests[i].data->size()});
    asked.push_back(i);
  }
  const auto found = session.transfer(questions);
  for (std::size_t k = 0; k < asked.size(); ++k) {
    const auto i = asked[k];
    out[i] = answers[i] ? after_answer(requests[i], found[k])
                        : after_lost_answer(requests[i], answers[i].error(), found[k]);
  }
  return out;
}

}  // namespace servoctl::session
