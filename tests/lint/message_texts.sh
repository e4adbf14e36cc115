#!/usr/bin/env bash
# Nothing is searched for in a finished sentence: Message::says() and Message::names() ask what it was made of.
# usage: message_texts.sh SOURCE_DIR
set -euo pipefail
cd "$1"
! grep -rnE '(message|hint|what|notice)(\(\))?\.text\(\)\.(find|rfind|starts_with|ends_with|contains|substr|replace|insert)\(' \
  src commands --include='*.cpp' --include='*.hpp'
