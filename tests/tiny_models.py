"""Models of the real classes, randomly initialised and as small as they come, in folders."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

torch = pytest.importorskip("torch", reason="needs the extra huggingface")
transformers = pytest.importorskip("transformers", reason="needs the extra huggingface")
torch.set_num_threads(1)  # tests share the machine

WORDS = (
    *("[PAD]", "[UNK]", "[CLS]", "[SEP]", "[MASK]"),
    *(".", "a", "bed", "chair", "chest", "drawers", "of", "photo", "plant", "potted"),
    *("refrigerator", "sofa", "stand", "table", "tele", "##vision", "toilet", "tv", "##s"),
)


def save_grounding_dino(folder: Path, seed: int = 0) -> Path:
    """Swin, BERT and a detection transformer, with 20 queries and up to 32 tokens of text."""
    transformers.set_seed(seed)
    config = transformers.GroundingDinoConfig(
        backbone_config=transformers.SwinConfig(
            image_size=64, embed_dim=16, depths=[1, 1, 1, 1], num_heads=[1, 1, 1, 1],
            window_size=2, out_indices=[2, 3, 4],
        ),
        text_config=transformers.BertConfig(
            vocab_size=len(WORDS), hidden_size=16, num_hidden_layers=1, num_attention_heads=2,
            intermediate_size=16, max_position_embeddings=32,
        ),
        num_queries=20, d_model=32, encoder_layers=1, decoder_layers=2, encoder_ffn_dim=32,
        decoder_ffn_dim=32, encoder_attention_heads=4, decoder_attention_heads=4, max_text_len=32,
    )  # fmt: skip
    transformers.GroundingDinoForObjectDetection(config).save_pretrained(folder)
    words = folder / "vocab.txt"
    words.write_text("\n".join(WORDS), encoding="utf-8")
    transformers.GroundingDinoProcessor(
        transformers.AutoImageProcessor.from_pretrained(_image_processor(
            folder, "GroundingDinoImageProcessor", size={"shortest_edge": 128, "longest_edge": 192}
        )),
        transformers.BertTokenizer(vocab=str(words)),
    ).save_pretrained(folder)  # fmt: skip
    return folder


def save_owlv2(folder: Path, seed: int = 0) -> Path:
    """A vision transformer of 4 x 4 patches and a text transformer."""
    transformers.set_seed(seed)
    text = {"vocab_size": 190, "hidden_size": 16, "intermediate_size": 16, "num_hidden_layers": 1,
            "num_attention_heads": 2, "bos_token_id": 188, "eos_token_id": 189}  # fmt: skip
    vision = {"image_size": 64, "patch_size": 16, "hidden_size": 16, "intermediate_size": 16,
              "num_hidden_layers": 1, "num_attention_heads": 2}  # fmt: skip
    config = transformers.Owlv2Config(text_config=text, vision_config=vision, projection_dim=16)
    transformers.Owlv2ForObjectDetection(config).save_pretrained(folder)
    transformers.Owlv2Processor(
        transformers.AutoImageProcessor.from_pretrained(_image_processor(
            folder, "Owlv2ImageProcessor", size={"height": 64, "width": 64}
        )),
        _letter_tokenizer(folder),
    ).save_pretrained(folder)  # fmt: skip
    return folder


def save_sam(folder: Path, seed: int = 0) -> Path:
    """SAM: its image encoder, prompt encoder and mask decoder."""
    transformers.set_seed(seed)
    vision = {"image_size": 64, "patch_size": 16, "hidden_size": 16, "output_channels": 16,
              "num_hidden_layers": 1, "num_attention_heads": 2, "mlp_dim": 16, "window_size": 0,
              "num_pos_feats": 8, "global_attn_indexes": [0]}  # fmt: skip
    prompt = {"hidden_size": 16, "image_size": 64, "patch_size": 16, "mask_input_channels": 4}
    decoder = {"hidden_size": 16, "mlp_dim": 16, "num_hidden_layers": 1, "num_attention_heads": 2,
               "iou_head_hidden_dim": 16, "iou_head_depth": 2}  # fmt: skip
    config = transformers.SamConfig(
        vision_config=vision, prompt_encoder_config=prompt, mask_decoder_config=decoder
    )
    transformers.SamModel(config).save_pretrained(folder)
    images = transformers.AutoImageProcessor.from_pretrained(_image_processor(
        folder, "SamImageProcessor", size={"longest_edge": 64},
        pad_size={"height": 64, "width": 64}, mask_size={"longest_edge": 16},
        mask_pad_size={"height": 16, "width": 16},
    ))  # fmt: skip
    transformers.SamProcessor(images).save_pretrained(folder)
    return folder


def _image_processor(folder: Path, name: str, **sizes: dict[str, int]) -> Path:
    """The file that tells which image processor a model has, as the hub's repositories bring it."""
    data = {"image_processor_type": name, **sizes}
    (folder / "preprocessor_config.json").write_text(json.dumps(data), encoding="utf-8")
    return folder


def _letter_tokenizer(folder: Path):
    """CLIP's tokenizer with letters for words and no merges."""
    letters = [chr(code) for code in range(ord("!"), ord("~") + 1)]
    ends = ["<|startoftext|>", "<|endoftext|>"]
    tokens = [*letters, *(letter + "</w>" for letter in letters), *ends]  # 188 + 2
    vocabulary = {token: index for index, token in enumerate(tokens)}
    return transformers.CLIPTokenizer(
        vocab=vocabulary, merges=[], pad_token=ends[1], model_max_length=16
    )
