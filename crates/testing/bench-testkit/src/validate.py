"""Faults of documents by a schema: {"schema": …, "documents": [...]} in, one list of texts for each document out."""

import json
import sys

from jsonschema import Draft202012Validator

given = json.load(sys.stdin)
Draft202012Validator.check_schema(given["schema"])
validator = Draft202012Validator(given["schema"])
faults = [[f"{fault.json_path}: {fault.message[:300]}" for fault in validator.iter_errors(document)]
          for document in given["documents"]]
json.dump(faults, sys.stdout)
