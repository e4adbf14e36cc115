#pragma once

#include <cstddef>
#include <cstdint>

/// Registers of an EtherCAT slave controller: addresses, and what their bits mean (ETG.1000.4, table 31 and
/// those of its clauses 6 and 7; ETG.1000.6, 5.3, for the AL registers). Words are little endian.
namespace servoctl::ethercat::reg {

inline constexpr std::uint16_t kType = 0x0000;                 ///< u8; u8 revision and u16 build behind it.
inline constexpr std::uint16_t kFmmuCount = 0x0004;            ///< u8
inline constexpr std::uint16_t kSyncManagers = 0x0005;         ///< u8
inline constexpr std::uint16_t kRamSize = 0x0006;              ///< u8, in KiB
inline constexpr std::uint16_t kPorts = 0x0007;                ///< u8, 2 bits a port
inline constexpr std::uint16_t kFeatures = 0x0008;             ///< u16
inline constexpr std::uint16_t kFeatureDc = 1U << 2U;          ///< It has distributed clocks.
inline constexpr std::uint16_t kFeatureDc64 = 1U << 3U;        ///< … of 64 bits; else of 32.
inline constexpr std::uint16_t kFeatureNoLrw = 1U << 9U;       ///< Its FMMUs know LRD and LWR, not LRW.
inline constexpr std::uint16_t kFeatureFixedFmmu = 1U << 11U;  ///< FMMUs and sync managers cannot be set.

inline constexpr std::uint16_t kStationAddress = 0x0010;  ///< u16, set by the master; 0 after power on.
inline constexpr std::uint16_t kStationAlias = 0x0012;    ///< u16, from the SII.

inline constexpr std::uint16_t kDlControl = 0x0100;       ///< u32
inline constexpr std::uint8_t kDlControlForward = 0x01;   ///< Bit 0: frames that are not EtherCAT end here.
inline constexpr std::uint16_t kDlControlAlias = 0x0103;  ///< u8, bit 0: the alias serves as address.
inline constexpr std::uint16_t kDlStatus = 0x0110;        ///< u16
constexpr std::uint16_t dl_link(unsigned port) {          ///< A cable is plugged in at this port, 0..3.
  return static_cast<std::uint16_t>(1U << (4U + port));
}
constexpr std::uint16_t dl_loop(unsigned port) {  ///< The port turns frames round: nothing is behind it.
  return static_cast<std::uint16_t>(1U << (8U + 2U * port));
}
constexpr std::uint16_t dl_signal(unsigned port) {  ///< Somebody answers at this port.
  return static_cast<std::uint16_t>(1U << (9U + 2U * port));
}

inline constexpr std::uint16_t kAlControl = 0x0120;     ///< u16, AlState and kAlAcknowledge
inline constexpr std::uint16_t kAlStatus = 0x0130;      ///< u16, AlState and kAlError
inline constexpr std::uint16_t kAlStatusCode = 0x0134;  ///< u16
inline constexpr std::uint16_t kAlStateMask = 0x000F;
inline constexpr std::uint16_t kAlAcknowledge = 0x0010;
inline constexpr std::uint16_t kAlError = 0x0010;
inline constexpr std::size_t kAlStatusSize = 6;  ///< From kAlStatus through kAlStatusCode.

inline constexpr std::uint16_t kEvents = 0x0220;  ///< u32, what the controller wants of its own processor
inline constexpr std::uint16_t kErrorCounters = 0x0300;  ///< 20 bytes, see the five below
/// u16 a port: low byte bad frames, high byte bad symbols. Writing anything clears all of them.
inline constexpr std::uint16_t kRxErrors = 0x0300;
inline constexpr std::uint16_t kForwardedErrors = 0x0308;   ///< u8 a port: frames that another has marked bad
inline constexpr std::uint16_t kProcessingErrors = 0x030C;  ///< u8
inline constexpr std::uint16_t kPdiErrors = 0x030D;         ///< u8
inline constexpr std::uint16_t kLostLinks = 0x0310;         ///< u8 a port

inline constexpr std::uint16_t kWatchdogDivider = 0x0400;       ///< u16: (value + 2) * 40 ns is one step
inline constexpr std::uint16_t kPdiWatchdog = 0x0410;           ///< u16 steps
inline constexpr std::uint16_t kSmWatchdog = 0x0420;            ///< u16 steps; 0: none
inline constexpr std::uint16_t kSmWatchdogStatus = 0x0440;      ///< u16, bit 0: outputs came in time
inline constexpr std::uint16_t kSmWatchdogCounter = 0x0442;     ///< u8, how often they did not
inline constexpr std::uint16_t kDefaultWatchdogDivider = 2498;  ///< 100 us
inline constexpr std::uint16_t kDefaultSmWatchdog = 1000;       ///< 100 ms

inline constexpr std::uint16_t kSiiAccess = 0x0500;    ///< u8; u8 behind it: bit 0, its processor is at it
inline constexpr std::uint8_t kSiiToProcessor = 0x01;  ///< The slave's own processor has the SII.
inline constexpr std::uint8_t kSiiForce = 0x02;        ///< Takes it from the processor.
inline constexpr std::uint8_t kSiiProcessorBusy = 0x01;
inline constexpr std::uint16_t kSiiControl = 0x0502;  ///< u16
inline constexpr std::uint16_t kSiiAddress = 0x0504;  ///< u32, in words
inline constexpr std::uint16_t kSiiData = 0x0508;     ///< 4 or 8 bytes
inline constexpr std::uint16_t kSiiWrite = 1U << 0U;
inline constexpr std::uint16_t kSiiEightBytes = 1U << 6U;  ///< A read brings 8 bytes, else 4.
inline constexpr std::uint16_t kSiiRead = 1U << 8U;
inline constexpr std::uint16_t kSiiChecksumError = 1U << 11U;  ///< In words 0 to 6.
inline constexpr std::uint16_t kSiiNotLoaded = 1U << 12U;
inline constexpr std::uint16_t kSiiCommandError = 1U << 13U;  ///< No acknowledge, or a command it cannot do.
inline constexpr std::uint16_t kSiiWriteError = 1U << 14U;
inline constexpr std::uint16_t kSiiBusy = 1U << 15U;

inline constexpr std::uint16_t kFmmu = 0x0600;
inline constexpr std::size_t kFmmuSize = 16;
constexpr std::uint16_t fmmu(unsigned number) {
  return static_cast<std::uint16_t>(kFmmu + kFmmuSize * number);
}
inline constexpr std::uint8_t kFmmuReads = 1;   ///< Inputs: the master reads.
inline constexpr std::uint8_t kFmmuWrites = 2;  ///< Outputs: the master writes.

inline constexpr std::uint16_t kSyncManager = 0x0800;
inline constexpr std::size_t kSyncManagerSize = 8;  ///< u16 start, u16 length, control, status, u16 activate
constexpr std::uint16_t sync_manager(unsigned number) {
  return static_cast<std::uint16_t>(kSyncManager + kSyncManagerSize * number);
}
constexpr std::uint16_t sm_status(unsigned number) {
  return static_cast<std::uint16_t>(sync_manager(number) + 5);
}
constexpr std::uint16_t sm_activate(unsigned number) {  ///< u8; u8 sm_processor() behind it.
  return static_cast<std::uint16_t>(sync_manager(number) + 6);
}
constexpr std::uint16_t sm_processor(unsigned number) {
  return static_cast<std::uint16_t>(sync_manager(number) + 7);
}
inline constexpr std::uint8_t kSmMailboxOut = 0x26;       ///< Control of SM0: one buffer, the master writes.
inline constexpr std::uint8_t kSmMailboxIn = 0x22;        ///< Control of SM1: one buffer, the master reads.
inline constexpr std::uint8_t kSmOutputs = 0x64;          ///< Control of SM2: three buffers, watchdog.
inline constexpr std::uint8_t kSmInputs = 0x20;           ///< Control of SM3: three buffers.
inline constexpr std::uint8_t kSmControlWatchdog = 0x40;  ///< Bit 6 of a control byte.
inline constexpr std::uint8_t kSmFull = 0x08;             ///< Status: the one buffer is written and not read.
inline constexpr std::uint8_t kSmEnable = 0x01;           ///< Activate.
inline constexpr std::uint8_t kSmRepeat = 0x02;  ///< Activate: a change asks for the last message again.
inline constexpr std::uint8_t kSmRepeatDone =
    0x02;  ///< Of sm_processor(): follows kSmRepeat when it is there.

inline constexpr std::uint16_t kDcReceiveTimes = 0x0900;     ///< u32 a port; writing latches all of them
inline constexpr std::uint16_t kDcSystemTime = 0x0910;       ///< u64, ns since 2000
inline constexpr std::uint16_t kDcUnitReceiveTime = 0x0918;  ///< u64
inline constexpr std::uint16_t kDcOffset = 0x0920;           ///< u64
inline constexpr std::uint16_t kDcDelay = 0x0928;            ///< u32, ns
inline constexpr std::uint16_t kDcDifference = 0x092C;       ///< u32, bit 31: the sign
inline constexpr std::uint16_t kDcSpeedStart = 0x0930;       ///< u16
inline constexpr std::uint16_t kDcFilter = 0x0934;           ///< u16
inline constexpr std::uint16_t kDcCyclicControl = 0x0980;    ///< u8
inline constexpr std::uint16_t kDcActivation = 0x0981;       ///< u8, bit 0 cyclic, bit 1 SYNC0, bit 2 SYNC1
inline constexpr std::uint16_t kDcStart = 0x0990;            ///< u64, ns
inline constexpr std::uint16_t kDcSync0Cycle = 0x09A0;       ///< u32, ns
inline constexpr std::uint16_t kDcSync1Cycle = 0x09A4;       ///< u32, ns

/// Where the memory of a slave for mailboxes and process data begins; below are registers.
inline constexpr std::uint16_t kProcessMemory = 0x1000;

}  // namespace servoctl::ethercat::reg
