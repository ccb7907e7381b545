#pragma once
// One loop over independent items on several threads. What each item writes must not depend on who computes it.

#include "kerf/types.hpp"

#include <functional>

namespace kerf {

/// body(begin, end) on contiguous chunks that cover [0, count). Runs on the calling thread when threads <= 1 or the
/// loop is short. The first exception that a chunk throws is rethrown here.
void parallel_for(Index count, int threads, const std::function<void(Index begin, Index end)>& body);

/// body(i) for every i in [0, count), each on whichever thread is free next: for few items of uneven work.
void parallel_tasks(Index count, int threads, const std::function<void(Index)>& body);

}  // namespace kerf
