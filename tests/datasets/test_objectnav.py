"""ObjectNav episode files: the published ones, made ones, and broken ones."""

from __future__ import annotations

import gzip
import json
import math
from pathlib import Path, PurePosixPath
from typing import Any

import numpy as np
import pytest
from episode_files import SCENE_ID, TASK_IDS, content, episode, goal, viewpoint, write
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from shared_data import shared_data
from toponav.datasets import (
    ObjectNavDataset,
    check_objectnav,
    is_objectnav_file,
    load_objectnav,
    missing_file,
    save_objectnav,
    scene_file,
)
from toponav.datasets.scene_files import Version, version_of
from toponav.errors import InputError

PUBLISHED = {"hm3d/v1": "hm3d-v1", "hm3d/v2": "hm3d-v2", "mp3d/v1": "mp3d-v1"}
every_published_file = pytest.mark.parametrize("which", PUBLISHED)


def published(which: str) -> Path:
    return shared_data(f"objectnav/{which}/val_mini/val_mini.json.gz")


def raw(path: Path) -> Any:
    return json.loads(gzip.decompress(path.read_bytes()))


@every_published_file
def test_published_files_are_read_whole(which: str) -> None:
    dataset = load_objectnav(published(which))
    assert dataset.version.value == PUBLISHED[which]
    assert len(dataset.episodes) == 30
    keys = [(episode.scene, episode.index) for episode in dataset.episodes]
    assert len(set(keys)) == 30
    for one in dataset.episodes:
        assert one.goals
        assert one.tilt < 1e-3
        assert all(goal.viewpoints.shape[1] == 3 for goal in one.goals)


@every_published_file
def test_published_paths_are_no_shorter_than_straight_lines(which: str) -> None:
    dataset = load_objectnav(published(which))
    for one in dataset.episodes:
        straight = min(math.dist(one.start, point) for point in one.viewpoints)
        assert straight <= one.geodesic_distance + 1e-3
    report = check_objectnav(dataset)
    assert report.problems == ()
    assert report.episodes == sum(report.by_scene.values()) == sum(report.by_target.values()) == 30
    assert 0.08 < report.viewpoint_spacing_m < 0.1


@every_published_file
def test_published_files_round_trip(which: str, tmp_path: Path) -> None:
    first = load_objectnav(published(which))
    save_objectnav(first, tmp_path)
    for name in first.files:
        assert raw(tmp_path / name) == raw(published(which).parent / name)
    second = load_objectnav(tmp_path / "val_mini.json.gz")
    assert same(first, second)
    before = {name: (tmp_path / name).read_bytes() for name in first.files}
    save_objectnav(second, tmp_path)
    assert before == {name: (tmp_path / name).read_bytes() for name in first.files}


def same(a: ObjectNavDataset, b: ObjectNavDataset) -> bool:
    def told(dataset: ObjectNavDataset) -> list[tuple[Any, ...]]:
        return [
            (e.scene, e.index, e.start, e.yaw, e.target, e.viewpoints.tolist())
            for e in dataset.episodes
        ]

    return told(a) == told(b)


@given(x=st.floats(-50, 50), y=st.floats(-5, 5), z=st.floats(-50, 50), turn=st.floats(-3.1, 3.1))
def test_poses_come_out_in_our_frame(
    x: float, y: float, z: float, turn: float, tmp_path_factory: pytest.TempPathFactory
) -> None:
    """Habitat's agent looks along -z and turns about +y: our +y, and our yaw counts from +x."""
    rotation = Rotation.from_euler("y", turn).as_quat().tolist()
    path = tmp_path_factory.mktemp("poses") / "val.json.gz"
    write(path, content(episode(start_position=[x, y, z], start_rotation=rotation)))
    one = load_objectnav(path).episodes[0]
    assert one.start == pytest.approx((x, -z, y))
    assert math.remainder(one.yaw - (math.pi / 2 + turn), math.tau) == pytest.approx(0.0, abs=1e-6)
    np.testing.assert_allclose(one.viewpoints, [[1.0, 2.0, 0.1], [1.085, 2.0, 0.1]])


def test_episodes_are_numbered_by_scene_and_share_their_goals(tmp_path: Path) -> None:
    other = "mp3d/x8F5xyUWy9e/x8F5xyUWy9e.glb"
    goals = {"4ok3usBNeis.basis.glb_bed": [goal()], "x8F5xyUWy9e.glb_bed": [goal(9)]}
    parts = (episode(), episode(scene_id=other, goals=None), episode(episode_id="3"))
    dataset = load_objectnav(
        write(tmp_path / "val.json.gz", content(*parts, goals_by_category=goals))
    )
    keys = [(one.scene, one.index) for one in dataset.episodes]
    assert keys == [("4ok3usBNeis", 0), ("x8F5xyUWy9e", 0), ("4ok3usBNeis", 1)]
    first, elsewhere, last = dataset.episodes
    assert first.goals is last.goals
    assert elsewhere.goals[0].object_id == 9


def test_a_split_takes_its_episodes_from_the_folder_beside_it(tmp_path: Path) -> None:
    split = write(
        tmp_path / "val.json.gz", {"episodes": [], "category_to_task_category_id": TASK_IDS}
    )
    with pytest.raises(InputError, match=r"holds no episodes, and there are none in .*content"):
        load_objectnav(split)
    write(tmp_path / "content" / "4ok3usBNeis.json.gz", content())
    dataset = load_objectnav(split)
    assert list(dataset.files) == [
        PurePosixPath("val.json.gz"), PurePosixPath("content/4ok3usBNeis.json.gz")
    ]  # fmt: skip
    assert len(dataset.episodes) == 1


@pytest.mark.parametrize(
    ("data", "says"),
    [
        (content(episode(object_category="sofa")), r"episodes\[0\]: its goals .*_sofa' are not in"),
        (content(episode(start_position=[1.0, 2.0])), r"episodes\[0\].start_position: "),
        (content(episode(start_position=[1.0, 2.0, math.nan])), r"start_position\[2\]"),
        (content(episode(start_rotation=[0, 0, 0, 0])), "start_rotation .* is no quaternion"),
        (content(episode(info={"geodesic_distance": math.nan, "euclidean_distance": 1.0})),
         "geodesic_distance is not a number"),
        (content(episode(info={})), "info.geodesic_distance: Field required"),
        (content(episode(scene_id="")), "scene_id"),
        ({"episodes": 3, "category_to_task_category_id": {}}, "episodes: Input should be"),
        ([1, 2], "the whole"),
    ],
)  # fmt: skip
def test_broken_content_is_one_clear_line(tmp_path: Path, data: Any, says: str) -> None:
    path = write(tmp_path / "val.json.gz", data)
    with pytest.raises(InputError, match=says) as error:
        load_objectnav(path)
    assert str(path) in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("cut", [1, 30, 200])
def test_a_file_that_is_cut_short_says_so(tmp_path: Path, cut: int) -> None:
    path = write(tmp_path / "val.json.gz", content())
    path.write_bytes(path.read_bytes()[:-cut])
    with pytest.raises(InputError, match="damaged or cut short"):
        load_objectnav(path)


def test_what_is_no_gzip_or_no_json_says_so(tmp_path: Path) -> None:
    path = tmp_path / "val.json.gz"
    path.write_bytes(b"plain")
    with pytest.raises(InputError, match="not a gzip file"):
        load_objectnav(path)
    path.write_bytes(gzip.compress(b"{"))
    with pytest.raises(InputError, match="not JSON"):
        load_objectnav(path)
    with pytest.raises(InputError, match="No such file"):
        load_objectnav(tmp_path / "absent.json.gz")


def test_an_unreachable_goal_is_counted_and_no_problem(tmp_path: Path) -> None:
    far = episode(info={"geodesic_distance": math.inf, "euclidean_distance": 5.0})
    report = check_objectnav(load_objectnav(write(tmp_path / "val.json.gz", content(far))))
    assert report.unreachable == 1
    assert report.problems == ()


@pytest.mark.parametrize(
    ("data", "says"),
    [
        (content(episode(info={"geodesic_distance": 4.0, "euclidean_distance": 4.0})),
         "shorter than the straight line"),
        (content(episode(start_rotation=[0.0998334, 0.0, 0.0, 0.9950042])), "degrees off upright"),
        (content(goals_by_category={"4ok3usBNeis.basis.glb_bed": [goal(view_points=[])]}),
         "have no viewpoint"),
        (content(category_to_task_category_id={**TASK_IDS, "bed": 4}), "task id of bed is 4"),
    ],
)  # fmt: skip
def test_what_does_not_agree_is_a_problem(tmp_path: Path, data: Any, says: str) -> None:
    report = check_objectnav(load_objectnav(write(tmp_path / "val.json.gz", data)))
    assert len(report.problems) == 1
    assert says in report.problems[0]


@pytest.mark.parametrize(
    ("scene_id", "version", "hint"),
    [
        ("hm3d/val/00800-T/T.basis.glb", Version.HM3D_V1, "--uids hm3d_val_v0.1"),
        (SCENE_ID, Version.HM3D_V2, "--uids hm3d_val_v0.2"),
        ("mp3d/x8F/x8F.glb", Version.MP3D_V1, "download_mp.py"),
        ("mine/a.glb", Version.OTHER, "put the dataset's scenes there"),
    ],
)
def test_a_missing_scene_is_named_with_its_place(
    scene_id: str, version: Version, hint: str
) -> None:
    assert version_of(scene_id) is version
    expected = Path("data") / "scene_datasets" / scene_id
    assert scene_file(scene_id, Path("data")) == expected
    message = missing_file(scene_id, Path("data"))
    assert message is not None
    assert message.startswith(f"{expected}: no such file")
    assert hint in message


@pytest.mark.parametrize("scene_id", ["../../etc/passwd", "/etc/passwd", "hm3d/../../x.glb"])
def test_a_scene_id_cannot_lead_out_of_its_folder(scene_id: str) -> None:
    with pytest.raises(InputError, match="no path below scene_datasets"):
        scene_file(scene_id, Path("data"))


def test_episode_files_are_told_from_houses(tmp_path: Path) -> None:
    plain = tmp_path / "plain.json"
    plain.write_text(json.dumps(content()))
    house = tmp_path / "house.json"
    house.write_text('{"format": "toponav-house/1", "name": "h", "levels": []}')
    assert is_objectnav_file(write(tmp_path / "val.json.gz", content()))
    assert is_objectnav_file(plain)
    assert not is_objectnav_file(house)
    assert not is_objectnav_file(tmp_path / "absent.json.gz")
    assert not is_objectnav_file(tmp_path)
    assert len(load_objectnav(plain).episodes) == 1


def test_viewpoints_of_all_goals_count(tmp_path: Path) -> None:
    two = [goal(1), goal(2, view_points=[viewpoint(0.0, 0.5, -1.0)])]
    data = content(goals_by_category={"4ok3usBNeis.basis.glb_bed": two})
    one = load_objectnav(write(tmp_path / "val.json.gz", data)).episodes[0]
    assert [len(instance.viewpoints) for instance in one.goals] == [2, 1]
    np.testing.assert_allclose(one.viewpoints[-1], [0.0, 1.0, 0.5])
