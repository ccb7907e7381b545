#pragma once
// The font of pictures, where the system may have none.

namespace kerf {

/// Archives and wheels bring a font and a fonts.conf beside the program: without any font pictures have boxes in place
/// of letters. Tells fontconfig of it, unless the environment says where its files are. It changes the environment:
/// call it before the first thread.
void offer_own_font();

}  // namespace kerf
