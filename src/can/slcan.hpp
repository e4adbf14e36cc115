#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "can/bus.hpp"
#include "can/foreign_clock.hpp"
#include "can/serial_port.hpp"
#include "can/slcan_codec.hpp"
#include "can/slcan_opening.hpp"
#include "can/slcan_place.hpp"
#include "can/slcan_watch.hpp"

namespace servoctl::can {

/// Opens an adapter of the LAWICEL protocol: `/dev/ttyACM0@1M`, see parse_slcan_place(). Errors as there, and
/// of SerialPort::open(); Errc::bus where nothing answers as an adapter does; Errc::usage where it refuses
/// the bitrate, or to listen only; Errc::interrupted by a signal.
Result<std::unique_ptr<Bus>> open_slcan(std::string_view place,
                                        SlcanOpening::Mode mode = SlcanOpening::Mode::normal);

/// A bus behind such an adapter, closed with C in the end. A frame counts as sent when the adapter has
/// acknowledged it; one that it refuses, because its queue is full, is offered again for a second.
/// Where its firmware acknowledges nothing, a frame counts as sent when the port has taken it. One that says
/// nothing any more, or has started anew and is closed, is lost: it is asked for its flags or its version.
class SlcanBus final : public Bus {
 public:
  SlcanBus(SlcanPlace place, SlcanOpening::Mode mode) : place_(std::move(place)), mode_(mode) {}
  ~SlcanBus() override;

  /// As open_slcan(). `limit` ends it early; kNever: as long as the rounds of SlcanOpening take. A signal
  /// ends it only where `ends_by_signal`.
  Result<void> open(TimePoint limit, bool ends_by_signal);

  /// Whether the last opening failed because it has no listen-only mode, or tells of none.
  bool refuses_to_listen() const { return refuses_to_listen_; }

  TimePoint now() const override { return steady_now(); }
  /// Errc::bug for a frame that is not one of ISO 11898-1.
  Result<void> send(const Frame& frame) override;
  Result<std::optional<Frame>> receive(TimePoint deadline) override;
  /// An opening that has not ended by then goes on with the next call.
  Result<void> recover(TimePoint deadline) override;
  Result<void> leave_for(std::uint32_t bitrate) override;
  /// Version, and whether it acknowledges and has flags.
  std::string about() const override;
  TimePoint arrived() const override { return arrived_; }
  int poll_fd() const override { return is_open() ? port_->get() : -1; }
  std::vector<Message> take_notices() override;
  TimePoint next_event() const override;

 private:
  enum class Answer : std::uint8_t { none, acknowledged, refused };
  static constexpr Duration kStampPeriod = std::chrono::minutes(1);
  struct Received {
    Frame frame;
    TimePoint time;
  };

  Result<void> begin();
  Result<void> hand_shake(TimePoint limit, bool ends_by_signal);
  Result<void> talk(TimePoint limit, bool ends_by_signal);
  bool is_open() const { return port_ && !opening_; }
  Result<void> judge(const SlcanOpening& opening) const;
  Result<void> write(std::string_view text, TimePoint limit);
  Result<void> fill();
  void on_line(const SlcanLine& line, TimePoint time);
  Result<Answer> answer_to_frame(TimePoint limit);
  Result<Answer> wait_for_answer(TimePoint limit);
  Result<Answer> wait_for_version(TimePoint limit);
  Result<Answer> wait_while(const std::function<bool()>& missing, TimePoint limit);
  void on_answer(Answer answer, bool has_letter);
  void await_watch();
  Result<void> ask_again();
  TimePoint stamped(std::uint16_t stamp, TimePoint time);
  void close();
  tl::unexpected<Error> lose(Error error);
  tl::unexpected<Error> not_open() const;

  SlcanPlace place_;
  SlcanOpening::Mode mode_;
  std::optional<SerialPort> port_;
  std::optional<SlcanOpening> opening_;  ///< The bus is not open yet.
  std::optional<Error> lost_;            ///< Why there is no port any more.
  SlcanReader reader_;
  ForeignClock stamps_{kStampPeriod};
  bool long_stamps_ = false;  ///< They count to 65,536 ms.
  bool refuses_to_listen_ = false;
  bool acknowledges_ = false;
  bool acknowledges_frames_ = true;  ///< Until the first one is not; again when one is.
  bool frame_was_acknowledged_ = false;
  std::string version_;
  bool version_came_ = false;     ///< Since it was set back.
  Answer answer_ = Answer::none;  ///< To the frame that was sent last.
  bool is_offering_ = false;      ///< That answer is waited for.
  SlcanWatch watch_;
  std::size_t damaged_ = 0;       ///< Lines since they were last told.
  std::size_t unanswered_ = 0;    ///< Frames whose acknowledge was lost; the same.
  std::size_t refused_late_ = 0;  ///< Frames that nobody waited for any more; the same.
  std::deque<Received> inbox_;
  TimePoint arrived_{};
};

}  // namespace servoctl::can
