"""Open-vocabulary models of the real classes, tiny and untrained, through their real processors."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("torch", reason="needs the extra huggingface")
pytest.importorskip("transformers", reason="needs the extra huggingface")

from tiny_models import save_grounding_dino, save_owlv2, save_sam, transformers
from toponav.errors import InputError
from toponav.perception.huggingface.detector import HuggingFaceConfig, HuggingFaceDetector
from toponav.perception.huggingface.phrases import GroundingPrompt, grounding_prompts

VOCABULARY = ("chair", "chest_of_drawers", "tv_monitor", "plant", "fridge")
EVERYTHING = HuggingFaceConfig(threshold=0.0)


@pytest.fixture(scope="module")
def models(tmp_path_factory: pytest.TempPathFactory):
    folder = tmp_path_factory.mktemp("models")
    savers = {"grounding_dino": save_grounding_dino, "owlv2": save_owlv2, "sam": save_sam}
    for name, save in savers.items():
        (folder / name).mkdir()
        save(folder / name)
    return folder


@pytest.fixture(scope="module")
def photo():
    return np.random.default_rng(0).integers(0, 255, (48, 64, 3)).astype(np.uint8)


@pytest.mark.parametrize("name", ["grounding_dino", "owlv2"])
def test_boxes_lie_in_the_image_and_have_names_of_the_vocabulary(models, photo, name) -> None:
    seen = HuggingFaceDetector(str(models / name), EVERYTHING).detect(photo, VOCABULARY)
    assert len(seen) > 0
    assert set(seen.labels) <= set(VOCABULARY)
    assert seen.masks_are_boxes
    assert (np.diff(seen.scores) <= 0.0).all()
    assert (seen.boxes >= 0.0).all()
    assert (seen.boxes <= [64, 48, 64, 48]).all()
    assert seen.masks.any(axis=(1, 2)).all()


@pytest.mark.parametrize("name", ["grounding_dino", "owlv2"])
def test_a_batch_says_what_single_images_say(models, photo, name) -> None:
    detector = HuggingFaceDetector(str(models / name), HuggingFaceConfig(threshold=0.0, batch=2))
    images = [photo, photo[::-1].copy(), photo[:, ::-1].copy()]
    together = detector.detect_all(images, VOCABULARY)
    alone = [detector.detect(image, VOCABULARY) for image in images]
    for one, other in zip(together, alone, strict=True):
        assert one.labels == other.labels
        np.testing.assert_allclose(one.scores, other.scores, atol=1e-4)
        np.testing.assert_allclose(one.boxes, other.boxes, atol=1e-2)


def test_the_library_reads_the_same_boxes_for_owlv2(models, photo) -> None:
    """What OWLv2's own processor makes of its outputs, the best class of each box."""
    detector = HuggingFaceDetector(str(models / "owlv2"), EVERYTHING)
    loaded = detector._loaded
    texts = [[f"a photo of a {name}" for name in ("chair", "bed")]]
    inputs = loaded.processor(images=photo, text=texts, return_tensors="pt")
    (theirs,) = loaded.processor.post_process_grounded_object_detection(
        loaded.run(inputs), threshold=0.0, target_sizes=[(48, 64)]
    )
    own = detector.detect(photo, ("chair", "bed"))
    low, high = np.zeros(4), np.array([64, 48, 64, 48])
    boxes = np.clip(theirs["boxes"].numpy(), low, high)
    for box, label in zip(own.boxes, own.labels, strict=True):
        distance = np.abs(boxes - box).max(axis=1)
        assert distance.min() < 0.01
        assert ("chair", "bed")[int(theirs["labels"][distance.argmin()])] == label


def test_masks_stay_within_their_boxes(models, photo) -> None:
    folder = str(models / "grounding_dino")
    boxes = HuggingFaceDetector(folder, EVERYTHING).detect(photo, VOCABULARY)
    config = HuggingFaceConfig(threshold=0.0, masks=str(models / "sam"))
    seen = HuggingFaceDetector(folder, config).detect(photo, VOCABULARY)
    assert not seen.masks_are_boxes
    assert seen.labels == boxes.labels
    assert not (seen.masks & ~boxes.masks).any()
    assert (seen.masks != boxes.masks).any()


def test_half_precision_runs(models, photo) -> None:
    config = HuggingFaceConfig(threshold=0.0, dtype="bfloat16", device="cpu")
    seen = HuggingFaceDetector(str(models / "owlv2"), config).detect(photo, ("chair",))
    assert len(seen) > 0
    assert np.isfinite(seen.scores).all()


def test_a_prompt_knows_the_words_of_each_phrase(models) -> None:
    tokenizer = transformers.AutoTokenizer.from_pretrained(models / "grounding_dino")
    phrases = ["chair", "chest of drawers", "television"]
    ((part, prompt),) = grounding_prompts(tokenizer, phrases, 32)
    assert part == slice(0, 3)
    ids = np.array(tokenizer(prompt.text).input_ids)
    words = [tokenizer.decode(ids[row]) for row in prompt.tokens]
    assert words == phrases


def test_a_long_vocabulary_is_asked_in_parts(models, photo) -> None:
    tokenizer = transformers.AutoTokenizer.from_pretrained(models / "grounding_dino")
    phrases = ["chest of drawers"] * 9
    parts = grounding_prompts(tokenizer, phrases, 16)
    assert [index for part, _ in parts for index in range(9)[part]] == list(range(9))
    assert all(len(tokenizer(prompt.text).input_ids) <= 16 for _, prompt in parts)
    names = [f"chair {number}" for number in range(20)]  # 60 tokens and more; the model reads 32
    seen = HuggingFaceDetector(str(models / "grounding_dino"), EVERYTHING).detect(photo, names)
    assert set(seen.labels) <= set(names)


def test_a_phrase_scores_the_mean_of_its_words() -> None:
    tokens = np.array([[0, 1, 0, 0, 0], [0, 0, 0, 1, 1]], np.bool_)
    scores = GroundingPrompt("", tokens).scores(np.array([[9, 0.5, 9, 0.2, 0.4, 9]]))
    np.testing.assert_allclose(scores, [[0.5, 0.3]])


def test_models_of_another_kind_are_said(models) -> None:
    with pytest.raises(InputError, match="no model for detection in this folder"):
        HuggingFaceDetector(str(models / "sam"))
    config = HuggingFaceConfig(masks=str(models / "owlv2"))
    with pytest.raises(InputError, match="no model for masks in this folder"):
        HuggingFaceDetector(str(models / "owlv2"), config)
    with pytest.raises(InputError, match="cannot run on"):
        HuggingFaceDetector(str(models / "owlv2"), HuggingFaceConfig(device="cuda:7"))
