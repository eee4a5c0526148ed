"""Loads a shipped model in PyTorch with the snippet of docs/model-file.md itself, and compares its answers with the
self-test vectors in the header of the exported WGSL.

    python3 benches/peers/load_model.py [models/thesis]

Needs torch and safetensors (the environment that train.py makes has them). Exits with 1 where they differ.
"""

import pathlib
import re
import sys

root = pathlib.Path(__file__).resolve().parents[2]
folder = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else root / "models" / "thesis"

text = (root / "docs" / "model-file.md").read_text(encoding="utf-8")
snippet = re.search(r"```python\n(.*?)```", text, re.S).group(1)
scope = {"__name__": "snippet"}
exec(compile(snippet, "docs/model-file.md", "exec"), scope)

import torch

model = scope["PeelnetModel"](str(folder / "model.safetensors")).eval()
header = (folder / "model.wgsl").read_text(encoding="utf-8")
vectors = re.findall(r"Self-test: peelnet_weight\((.*?)\) = (\S+)", header)
assert len(vectors) == 3, "the export's header has no three self-test vectors"

# Both sides compute in 32 bits: a few roundings of values around 1.
TOLERANCE = 1e-5
worst = 0.0
for inputs, answer in vectors:
    raw = torch.tensor([[float(x) for x in inputs.split(",")]])
    with torch.no_grad():
        worst = max(worst, abs(model(raw).item() - float(answer)))
print(f"{folder}: {len(vectors)} vectors, worst difference {worst:.1e} (allowed {TOLERANCE:.0e})")
sys.exit(0 if worst <= TOLERANCE else 1)
