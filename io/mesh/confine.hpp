#pragma once
// Geometries of gmsh are programs: SystemCall, Save, Printf and ExternalProcess start programs and write files. Here
// the kernel forbids it.

namespace kerf {

enum class Confined {
  Programs,  // none is started, no connection made, no other process disturbed
  Files,     // that, and no file made, opened for writing, renamed or removed
};

/// This thread, and threads that it starts, from now on: what is forbidden fails with EPERM [seccomp(2)]. False where
/// the system cannot do that.
bool confine(Confined what);

}  // namespace kerf
