"""Where a fleet's logs lie: folders by name, or a table of contents; what cannot be followed."""

import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from frictioncli.errors import LogError, MappingError
from frictioncli.fleet.joint_logs import find_joints


def folders(root, *places):
    for place in places:
        (root / place).mkdir(parents=True)
    return root


def contents(path, text):
    path.write_text(text, encoding="utf-8")
    return path


def told(fleet):
    return [(joint.robot, joint.joint) for joint in find_joints(fleet)]


def test_folders_come_in_natural_order(tmp_path):
    names = ("robot=r10/joint=2", "robot=r2/joint=10", "robot=r2/joint=3", "robot=r2/notes", "x")
    assert told(folders(tmp_path, *names)) == [("r2", 3), ("r2", 10), ("r10", 2)]


def test_runs_of_a_folder_are_named_by_it_in_natural_order(tmp_path):
    (joint,) = find_joints(folders(tmp_path, *(f"robot=A/joint=1/run={n}" for n in (10, 9, 1))))
    assert list(joint.runs()) == ["1", "9", "10"]
    assert joint.runs()["9"] == tmp_path / "robot=A" / "joint=1" / "run=9"


def test_a_joint_without_runs_is_only_found_out_by_who_works_on_it(tmp_path):
    (joint,) = find_joints(folders(tmp_path, "robot=A/joint=1/2024"))
    with pytest.raises(LogError, match=r"joint=1: no folders of runs; expected run=D"):
        joint.runs()


@pytest.mark.parametrize("name", ["joint=x", "joint=0", "joint=-1", "joint=", "joint=99999"])
def test_a_joint_needs_a_number(tmp_path, name):
    with pytest.raises(MappingError, match="expected a joint number from 1"):
        find_joints(folders(tmp_path, f"robot=A/{name}"))


def test_one_number_twice_is_refused(tmp_path):
    with pytest.raises(MappingError, match="robot A, joint 2 is there twice"):
        find_joints(folders(tmp_path, "robot=A/joint=2", "robot=A/joint=02"))


def test_nothing_there(tmp_path):
    with pytest.raises(LogError, match="no joints found"):
        find_joints(tmp_path)
    with pytest.raises(LogError, match="no such file or folder"):
        find_joints(tmp_path / "none")


@pytest.mark.parametrize("separator", [",", ";"])
@pytest.mark.parametrize("bom", ["", "\ufeff"])
def test_a_table_of_contents_gives_joints_and_runs(tmp_path, separator, bom):
    rows = [
        ("robot", "joint", "run", "path", "map", "gear_ratio"),
        ("B", "1", "d10", "logs/b10.csv", "", "-100.5"),
        ("A", "2", "d1", "logs/a", "xarm.toml", ""),
        ("B", "1", "d9", "/elsewhere/b9", "", "-100.5"),
    ]
    text = bom + "\n".join(separator.join(row) for row in rows) + "\n\n"
    first, second = find_joints(contents(tmp_path / "fleet.csv", text))
    assert (first.robot, first.joint, first.map_file) == ("A", 2, tmp_path / "xarm.toml")
    assert first.runs() == {"d1": tmp_path / "logs" / "a"}
    assert (second.robot, second.joint, second.gear_ratio) == ("B", 1, -100.5)
    assert list(second.runs()) == ["d9", "d10"]
    assert str(second.runs()["d9"]) == "/elsewhere/b9"


def test_parquet_says_the_same_as_csv(tmp_path):
    frame = pd.DataFrame(
        {"robot": ["A", "A", "7"], "joint": [1, 1, 2], "run": ["x", "y", "x"]}
        | {"path": ["p/1", "p/2", "p/3"], "gear_ratio": [None, None, 89.25]}
    )
    frame.to_parquet(tmp_path / "fleet.parquet")
    frame.to_csv(tmp_path / "fleet.csv", index=False)
    assert find_joints(tmp_path / "fleet.parquet") == find_joints(tmp_path / "fleet.csv")


HEADER = "robot,joint,run,path\n"


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("robot,run\nA,d\n", r"columns joint, path are missing; found robot, run"),
        ("", "columns robot, joint, run, path are missing"),
        (HEADER, "no joints found"),
        (HEADER + "A,1,,p\n", "row 2: run is empty"),
        (HEADER + "A,1,d\n", "row 2: 3 cells, expected 4"),
        (HEADER + "A,one,d,p\n", "row 2: joint 'one'; expected a joint number"),
        (HEADER + "A,1,d,p\nA,1,d,q\n", "row 3: robot A, joint 1 has d in an earlier row"),
        (HEADER + "A,1,d,p\nA,1,e,./p\n", "row 3: robot A, joint 1 has .*p in an earlier row"),
        (HEADER + "A,1,d,../p\n", "row 2: path ../p leads outside the folder"),
        (HEADER + "A,1,d,p/../../q\n", "leads outside the folder"),
        (HEADER + "../A,1,d,p\n", "robot '../A' cannot be part of a folder's name"),
        ("robot,joint,run,path,gear_ratio\nA,1,d,p,fast\n", "gear_ratio 'fast'; expected motor"),
        ("robot,joint,run,path,map\nA,1,d,p,a\nA,1,e,q,b\n", "row 3: map or gear_ratio differs"),
    ],
)
def test_a_table_that_cannot_be_followed_says_where_and_why(tmp_path, text, words):
    with pytest.raises((MappingError, LogError), match=words):
        find_joints(contents(tmp_path / "fleet.csv", text))


def test_what_is_no_table(tmp_path):
    (tmp_path / "a").write_bytes(b"PAR1 but no more")
    (tmp_path / "b").write_bytes(b"\xff\xfe\x00robot")
    for name, words in (("a", "as Parquet"), ("b", "as UTF-8 text")):
        with pytest.raises(MappingError, match=words):
            find_joints(tmp_path / name)


NAMES = st.text(st.characters(codec="utf-8", exclude_characters='/\\"'), min_size=1, max_size=30)


@given(robot=NAMES, path=st.text(st.sampled_from("ab./"), min_size=1, max_size=12))
def test_no_work_folder_and_no_relative_path_leaves_its_place(tmp_path_factory, robot, path):
    base = tmp_path_factory.mktemp("fleet")
    pd.DataFrame({"robot": [robot], "joint": [1], "run": ["d"], "path": [path]}).to_parquet(
        base / "fleet.parquet"
    )
    try:
        (joint,) = find_joints(base / "fleet.parquet")
    except MappingError:
        return
    assert len(joint.subfolder.parts) == 2
    assert ".." not in joint.subfolder.parts
    if not path.startswith("/"):
        (place,) = joint.runs().values()
        assert place.resolve().is_relative_to(base.resolve())
