#pragma once
// What the browser draws from: a JSON header and arrays, as elements of the page.

#include "plot/page/sections.hpp"

namespace kerf {

std::string data_elements(const Result& result, const PageData& data);

// Made from plot/page/browser by build.sh, committed, and compiled in.
const char* browser_script();
const char* browser_style();
const char* browser_script_sha256();  // in hexadecimal digits

}  // namespace kerf
