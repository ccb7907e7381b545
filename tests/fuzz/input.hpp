#pragma once
// What the program is given: a command line and files, made from two numbers and the corpus.

#include "tests/fuzz/dice.hpp"
#include "tests/fuzz/tree.hpp"

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace kerf::fuzz {

struct Seed {
  std::string name;  // of the file
  Value document;
  std::map<std::string, std::string> files;  // what it names: meshes, tables
};

using Corpus = std::vector<Seed>;

/// All *.toml of the folders, by name. A file that is no TOML is left out. Throws std::runtime_error when there is
/// none.
Corpus read_corpus(const std::vector<std::filesystem::path>& folders);

struct Input {
  std::vector<std::string> arguments;         // without the program
  std::map<std::string, std::string> files;   // in its folder, case.toml among them
  std::string from = {};                      // of the corpus
  std::vector<std::string> environment = {};  // NAME=VALUE, besides what every child gets
};

/// The input of that number: the same for the same corpus on every machine.
Input make_input(const Corpus& corpus, std::uint64_t seed, std::uint64_t number);

// Parts of it.

/// One change of structure, value, name, geometry or expression.
void mutate(Dice& dice, Value& document, const Corpus& corpus);
/// A number as it should not be, or another one like it ("" : any).
std::string odd_number(Dice& dice, const std::string& like);
/// An expression of x, y, nx, ny that is mostly well formed.
std::string odd_expression(Dice& dice, int depth);
/// A value for the key of that path, where the table of keys has it; its example, one of its words, or odd.
Value value_for(Dice& dice, std::string_view path);
/// Flips, cuts, repeats, and bytes that are no text.
void damage(Dice& dice, std::string& bytes);
/// The same, but mostly numbers and lines of a text.
void damage_lines(Dice& dice, std::string& text);
/// A mesh so coarse, limits so low that thousands can be run.
void tame(Dice& dice, Value& document);

/// What is in a file; nothing where there is none.
std::string bytes_of(const std::filesystem::path& path);

}  // namespace kerf::fuzz
