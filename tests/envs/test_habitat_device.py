"""On which device Habitat renders; needs no habitat-sim."""

from __future__ import annotations

import pytest

from toponav.envs.habitat.simulator import FIRST_EGL_DEVICE, GPU_VARIABLE, gpu_device
from toponav.errors import InputError


def test_any_device_unless_the_environment_names_one(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(GPU_VARIABLE, raising=False)
    assert gpu_device() == FIRST_EGL_DEVICE
    monkeypatch.setenv(GPU_VARIABLE, "1")
    assert gpu_device() == 1
    monkeypatch.setenv(GPU_VARIABLE, "cuda:0")
    with pytest.raises(InputError, match=f"{GPU_VARIABLE}='cuda:0'"):
        gpu_device()
