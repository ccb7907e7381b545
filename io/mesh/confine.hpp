#pragma once
// Geometries of gmsh are programs: SystemCall, Save, Printf and ExternalProcess start programs and write files. Here
// the kernel forbids it.

#include <string>

namespace kerf {

enum class Confined {
  Programs,  // none is started, no connection made, no other process disturbed: only listed calls are made
  Files,     // that, and no file made, opened for writing, renamed or removed
};

/// This thread, and threads that it starts, from now on: what is forbidden fails with EPERM [seccomp(2)]. False where
/// the system cannot do that.
bool confine(Confined what);

/// This process, from now on: nothing on the disk is made, written or removed but what is in this file, which exists
/// [landlock(7)]. False where the kernel has no Landlock.
bool write_only(const std::string& path);

/// The working folder becomes one that is gone: nothing can be made under a relative name.
void stand_nowhere();

}  // namespace kerf
