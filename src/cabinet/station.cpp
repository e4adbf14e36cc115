#include "cabinet/station.hpp"

#include <pthread.h>
#include <algorithm>
#include <csignal>
#include <exception>
#include <list>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "session/interleave.hpp"
#include "session/option_scope.hpp"

namespace servoctl::cabinet {
namespace {

using ListProgress = std::function<void(std::size_t, std::size_t, TimePoint)>;

/// The jobs of one session.
struct Crew {
  session::Session* session = nullptr;
  std::vector<session::Job> jobs;
  std::thread thread;
  std::exception_ptr thrown;

  void run() {
    try {
      session::Interleave(*session, jobs).run();
    } catch (...) {
      thrown = std::current_exception();
    }
  }
};

/// How many of all have ended, told by one thread at a time.
class CommonProgress {
 public:
  CommonProgress(std::list<Crew>& crews, std::size_t total) : total_(total) {
    for (auto& crew : crews) {
      ListProgress tell;
      if (crew.session->options().list_progress)
        tell = [this, own = crew.session->options().list_progress](std::size_t, std::size_t, TimePoint now) {
          const std::lock_guard lock(mutex_);
          own(++ended_, total_, now);
        };
      scopes_.emplace_back(*crew.session, &session::Options::list_progress, std::move(tell));
    }
  }

 private:
  std::mutex mutex_;
  std::size_t ended_ = 0;
  std::size_t total_;
  std::list<session::OptionScope<ListProgress>> scopes_;
};

/// Whether another bus of this process cannot wait: whoever waits serves it, which is one thread's.
bool serves_another(const std::list<Crew>& crews) {
  return std::any_of(crews.begin(), crews.end(), [](const Crew& crew) {
    const auto& beside = crew.session->options().beside;
    return beside && beside() != Duration::max();
  });
}

using Beside = session::OptionScope<std::function<Duration()>>;

/// Signals stay with the thread that has the first session: its wait ends at once, those of the others soon.
void start_thread(Crew& crew) {
  sigset_t all;
  sigset_t before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  try {
    crew.thread = std::thread([&crew] { crew.run(); });
  } catch (...) {
    crew.thrown = std::current_exception();
  }
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

/// Nobody is served beside while each session has a thread.
void run_in_threads(std::list<Crew>& crews) {
  std::list<Beside> scopes;
  for (auto& crew : crews)
    scopes.emplace_back(*crew.session, &session::Options::beside, std::function<Duration()>());
  for (auto crew = std::next(crews.begin()); crew != crews.end(); ++crew) start_thread(*crew);
  crews.front().run();
  for (auto& crew : crews)
    if (crew.thread.joinable()) crew.thread.join();
}

}  // namespace

show::Desk desk_at(const show::Desk& line, const Station& station) {
  show::Desk out;
  out.session = station.session;
  out.profile = station.profile;
  out.nodes = {station.axis->node};
  out.chinese = line.chinese;
  out.dry_run = line.dry_run;
  out.state_folder = line.state_folder;
  return out;
}

void at_all(std::span<const Station> stations, const std::function<void(std::size_t station)>& work) {
  std::list<Crew> crews;
  std::size_t total = 0;
  for (std::size_t i = 0; i < stations.size(); ++i) {
    if (stations[i].away) continue;
    auto crew = crews.begin();
    while (crew != crews.end() && crew->session != stations[i].session) ++crew;
    if (crew == crews.end()) {
      crew = crews.emplace(crews.end());
      crew->session = stations[i].session;
    }
    crew->jobs.emplace_back([&work, i] { work(i); });
    ++total;
  }
  if (crews.empty()) return;
  // What one tells of its own progress is worth more than that it has ended.
  if (total == 1) return crews.front().jobs.front()();
  {
    const CommonProgress progress(crews, total);
    if (serves_another(crews)) {
      for (auto& crew : crews) crew.run();
    } else {
      run_in_threads(crews);
    }
  }
  for (const auto& crew : crews)
    if (crew.thrown) std::rethrow_exception(crew.thrown);
}

}  // namespace servoctl::cabinet
