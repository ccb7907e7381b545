#pragma once
// A request to stop, as Ctrl-C makes it: the one thing that all computations of a process share.

namespace kerf {

/// Asks all that computes to stop: within one factorization. May be called by a signal handler or by another thread.
void request_stop() noexcept;
bool stop_requested() noexcept;
/// The next computation may begin.
void forget_stop() noexcept;

/// What a computation throws that finds itself asked to stop. No Error: what catches a design that cannot be solved
/// must not catch this.
struct Stopped {};
/// Throws Stopped when a stop was asked for.
void check_stop();

}  // namespace kerf
