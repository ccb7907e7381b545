#!/usr/bin/env bash
# spelling.sh SOURCE: codespell finds no misspelled word in documents and sources. Words that are right here and that its list
# takes for others stand below. 77: codespell is not installed.
set -euo pipefail
command -v codespell >/dev/null || { echo "skipped: codespell is not installed"; exit 77; }
cd "$1"
# names, words of languages other than English, wrong words that tests give on purpose
words=statics,ue,te,ot,atleast,nin,yau,numer,mater,paeth,pres,lightening
(git ls-files -z 2>/dev/null || find . -path ./build -prune -o -type f -printf "%P\0") | grep -zE '\.(md|cpp|hpp|py|sh|toml|txt|cff|yaml)$|^dev$' |
  grep -zvE '^docs/(hard|proof|theory/bibliography)\.md$|^tests/fuzz/|^tests/.*_test\.(cpp|py)$' |
  xargs -0 codespell --ignore-words-list "$words"
echo "no misspelled words"
