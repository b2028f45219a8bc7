"""Models of the Hugging Face hub or of a local folder, brought to the best device there is."""

from __future__ import annotations

import contextlib
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any, Literal

from toponav.errors import InputError, MissingExtraError

Dtype = Literal["auto", "float32", "float16", "bfloat16"]
"""Precision of the arithmetic; `auto` is float16 on CUDA and float32 elsewhere."""

Task = Literal["detection", "masks"]

_AUTO_CLASSES: dict[Task, str] = {
    "detection": "AutoModelForZeroShotObjectDetection",
    "masks": "AutoModelForMaskGeneration",
}


@dataclass(frozen=True)
class Runtime:
    """Where and how a model runs.

    Attributes:
        device: As torch names it; "auto" is CUDA, else Apple's GPU, else the CPU.
        dtype: Weights stay float32; the arithmetic is done so, which keeps boxes exact where half
            precision would round their corners.
    """

    device: str = "auto"
    dtype: Dtype = "auto"


@dataclass(frozen=True, eq=False)
class Loaded:
    """A model with its processor.

    Attributes:
        model: In evaluation mode, on its device.
        processor: Makes its inputs and reads its outputs.
        torch: The library.
        dtype: Of the arithmetic, as torch names it.
    """

    model: Any
    processor: Any
    torch: Any
    dtype: Any

    def run(self, inputs: Any) -> Any:
        """The model's outputs for a processor's inputs, which are moved to its device."""
        device = self.model.device
        with self.torch.inference_mode(), self._precision(device.type):
            return self.model(**inputs.to(device))

    def _precision(self, device_type: str) -> Any:
        if self.dtype == self.torch.float32:
            return contextlib.nullcontext()
        return self.torch.autocast(device_type, self.dtype)


@lru_cache(maxsize=4)
def load(name: str, task: Task, runtime: Runtime) -> Loaded:
    """A model and its processor, once a process.

    Args:
        name: A folder that `save_pretrained` wrote, or a name on the hub.
        task: What it is to do.
        runtime: Where it runs.

    Raises:
        MissingExtraError: torch or transformers is not installed.
        InputError: No such model, an incomplete one, one of another kind, or no such device.
    """
    torch, transformers = _import_libraries()
    try:
        processor = transformers.AutoProcessor.from_pretrained(name)
        model = getattr(transformers, _AUTO_CLASSES[task]).from_pretrained(name)
    except ImportError as error:  # some models need a library of their own
        raise MissingExtraError(f"{name} needs more than is installed: {_line(error)}") from error
    except Exception as error:  # its readers fail in as many ways as there are file formats
        where = "in this folder" if Path(name).is_dir() else "as a folder or on the hub"
        raise InputError(f"no model for {task} {where}: {name}: {_line(error)}") from error
    device = _device(torch, runtime.device)
    try:
        model = model.to(device)
    except (RuntimeError, AssertionError) as error:
        raise InputError(f"{name} cannot run on {device}: {_line(error)}") from error
    return Loaded(model.eval(), processor, torch, _dtype(torch, runtime.dtype, device))


def _device(torch: Any, name: str) -> str:
    if name != "auto":
        return name
    if torch.cuda.is_available():
        return "cuda"
    return "mps" if torch.backends.mps.is_available() else "cpu"


def _dtype(torch: Any, name: Dtype, device: str) -> Any:
    if name == "auto":
        return torch.float16 if device.startswith("cuda") else torch.float32
    return getattr(torch, name)


def _line(error: Exception) -> str:
    """The first line of a message, which may be a page."""
    return next(iter(str(error).strip().splitlines()), type(error).__name__)


def _import_libraries() -> tuple[Any, Any]:
    try:
        import torch
        import transformers
    except ImportError as error:
        raise MissingExtraError(
            "the detector huggingface needs torch and transformers: "
            "pip install 'toponav[huggingface]'"
        ) from error
    transformers.utils.logging.set_verbosity_error()
    transformers.utils.logging.disable_progress_bar()
    return torch, transformers
