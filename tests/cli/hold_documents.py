#!/usr/bin/env python3
"""Holds the documents on its standard input, one a line, against docs/schema/; says what is wrong, and how many there were.

usage: servoctl … --json | hold_documents.py
"""
import os
import sys

from json_schemas import Schemas, samples_and_documents

schemas = Schemas(os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../docs/schema"))
problems = []
count = 0
for name, document in samples_and_documents(line.rstrip("\n") for line in sys.stdin):
    count += 1
    problems += [f"{name} ({document.get('command')}): {text}" for text in schemas.errors(name, document)]
if problems or count == 0:
    sys.exit("\n".join(problems) or "no document")
print(count)
