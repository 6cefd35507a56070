"""Rule files: what is read, what is refused with which sentence, and what cannot break the reader."""

import hashlib
import time
import tomllib

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stair_inspector.codes.limits import Limit
from stair_inspector.codes.rule_sets import RuleSet
from stair_inspector.errors import ConfigError, brief
from stair_inspector.files.paths import static_configs
from stair_inspector.files.rule_sets import (
    find_rule_set,
    list_rule_sets,
    parse_limit,
    parse_rule_set,
    read_rule_set,
    rule_set_path,
)

RULE = """
[[rules]]
id = "riser"
clause = "4.2"
term = "riser"
quantity = "rise"
statistic = "each"
minimum = "4 in"
maximum = "7 3/4 in"
severity = "limit"
from_scan = "yes"
grade = "P"
"""
HEAD = 'id = "my-city"\nname = "My City"\nedition = "2025"\nsource = "its bylaw"\n'
TEXT = HEAD + RULE


def parse(text) -> RuleSet:
    return parse_rule_set(text.encode(), "mine.toml")


# --- what is read --------------------------------------------------------------------------------------------------


def test_a_users_own_file_works_as_a_shipped_one(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text(TEXT, encoding="utf-8")
    rule_set = find_rule_set(str(path))
    assert rule_set == read_rule_set(path)
    assert (rule_set.set_id, rule_set.name, rule_set.edition, rule_set.variant) == ("my-city", "My City", "2025", "")
    assert rule_set.file == "mine.toml"
    assert rule_set.sha256 == hashlib.sha256(path.read_bytes()).hexdigest()
    assert rule_set.rule("riser").maximum == Limit.of("7 3/4", "in")
    assert rule_set.rule("riser").only_where is None
    assert not rule_set.is_overlay


def test_a_shipped_set_is_found_by_its_id():
    rule_set = find_rule_set("us-irc-2024")
    path = static_configs() / "codes" / "us-irc-2024.toml"
    assert rule_set == read_rule_set(path)
    assert rule_set.sha256 == hashlib.sha256(path.read_bytes()).hexdigest()


def test_all_shipped_sets_are_listed_by_id():
    ids = [rule_set.set_id for rule_set in list_rule_sets()]
    assert ids == sorted(path.stem for path in (static_configs() / "codes").glob("*.toml"))
    assert len(ids) >= 25


def test_everything_in_a_file_reaches_the_rules():
    """Read once more by another reader: no key is dropped, none is filled in."""
    for rule_set in list_rule_sets():
        values = tomllib.loads((static_configs() / "codes" / rule_set.file).read_text(encoding="utf-8"))
        assert list(rule_set.not_assessed) == values.get("not_assessed", [])
        for rule, record in zip(rule_set.rules, values["rules"], strict=True):
            assert rule.rule_id == record.pop("id")
            for side in ("minimum", "maximum"):
                limit = getattr(rule, side)
                assert (None if limit is None else limit.as_written.replace("°", " deg")) == record.pop(side, None)
            condition = record.pop("only_where", None)
            assert (rule.only_where is None) == (condition is None)
            if rule.only_where is not None:
                assert (rule.only_where.quantity, rule.only_where.below.as_written) == tuple(condition.values())
            assert {key: getattr(rule, key) for key in record} == record


@pytest.mark.parametrize(
    ("text", "written", "unit"),
    [
        ("3/8 in", "3/8", "in"),
        ("7 3/4 in", "7 3/4", "in"),
        (" 26 cm ", "26", "cm"),
        ("1.20 m", "1.20", "m"),
        ("26cm", "26", "cm"),
        ("42 deg", "42", "deg"),
        ("42°", "42", "deg"),
        ("2 %", "2", "%"),
        ("1:48", "1:48", "slope"),
        ("18", "18", "count"),
        ("7¾ in", "7 3/4", "in"),
        ("7 ¾ in", "7 3/4", "in"),
        ("½ in", "1/2", "in"),
        ("7 3⁄4 in", "7 3/4", "in"),
        ('7 3/4"', "7 3/4", "in"),
        ("7¾″", "7 3/4", "in"),
        ("7 3/4 ”", "7 3/4", "in"),
        ("12'", "12", "ft"),
        ("12′", "12", "ft"),
        # As a reading may be written.
        ("6 11/16''", "6 11/16", "in"),
        ("7 IN", "7", "in"),
        ("7 inches", "7", "in"),
        ("７ in", "7", "in"),
    ],
)
def test_limits_are_read_with_their_units(text, written, unit):
    assert parse_limit(text) == Limit.of(written, unit)


def test_a_byte_order_of_lines_does_not_matter_but_the_hash_is_that_of_the_bytes():
    unix, windows = parse(TEXT), parse(TEXT.replace("\n", "\r\n"))
    assert unix.rules == windows.rules
    assert unix.sha256 != windows.sha256


# --- what is refused -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("edition", "editon", "mine.toml: unknown key 'editon'; did you mean 'edition'?"),
        ('edition = "2025"\n', "", "mine.toml: edition is missing; add it"),
        ("severity", "severety", "mine.toml: rule 1 ('riser'): unknown key 'severety'; did you mean 'severity'?"),
        ('grade = "P"\n', "", "mine.toml: rule 1 ('riser'): grade is missing; add it"),
        ('id = "riser"\n', "", "mine.toml: rule 1: id is missing; add it"),
        ('"rise"', '"rice"', "mine.toml: rule 1 ('riser'): rule riser: quantity: got 'rice'; give one of rise, going"),
        ('"7 3/4 in"', '"7 3/4 inn"', "maximum: unit: unknown unit 'inn'; did you mean 'in'?"),
        ('"7 3/4 in"', '"7 3/4 furlong"', "maximum: unit: unknown unit 'furlong'; known are %, cm, deg, ft, in, m, mm"),
        ('"7 3/4 in"', "7.75", "maximum: got 7.75; write the limit in quotes with its unit, as '7 3/4 in'"),
        ('"7 3/4 in"', "nan", "maximum: got nan; write the limit in quotes with its unit"),
        ('"7 3/4 in"', '"nan in"', "maximum: got 'nan in'; write the limit with its unit"),
        ('"7 3/4 in"', '"-7 in"', "maximum: got '-7 in'; write the limit with its unit"),
        ('"7 3/4 in"', '"7 3/0 in"', "maximum: '7 3/0' is no number"),
        ('"7 3/4 in"', '"7"', "maximum: 7 has no unit; write one of m, cm, mm, in, ft after it"),
        ('"7 3/4 in"', '"7 3/4"', "maximum: got '7 3/4'; add a unit, as '7 3/4 in' or '180 mm'"),
        ('"7 3/4 in"', '"7,75 in"', "maximum: got '7,75 in'; write decimals with a point, as '180.5 mm', and"),
        ('"7 3/4 in"', '"1,000 mm"', "maximum: got '1,000 mm'; write decimals with a point, as '180.5 mm', and thousa"),
        (
            '"7 3/4 in"',
            '"1000000 ft"',
            "maximum: '1000000' has too many digits; give at most six, and nine after the p",
        ),
        ('"7 3/4 in"', '"0.1234567891 m"', "maximum: '0.1234567891' has too many digits; give at most six, and nine"),
        ('"7 3/4 in"', '"7 3/4 1/2 in"', "maximum: '7 3/4 1/2' is no number; write it as 11, 16.5, 3/8 or 7 3/4"),
        ('"7 3/4 in"', '"7 slope"', "maximum: unit: unknown unit 'slope'"),
        ('"7 3/4 in"', '"1:48"', "maximum: 1:48 is no limit of rise"),
        ('"7 3/4 in"', '"3 in"', "minimum 4 in (101.6 mm) is above maximum 3 in (76.2 mm); exchange them"),
        ('"my-city"', '"My City!"', "mine.toml: set id 'My City!': give up to 80 small letters, digits"),
        ('"my-city"', "7", "mine.toml: set id 7: give up to 80 small letters"),
        ('"My City"', '""', "mine.toml: rule set my-city: name: is empty; fill it in"),
        ('"My City"', "[1]", "mine.toml: rule set my-city: name: give a text"),
        ('"My City"', '"\\u001b[2J"', "name: holds a line break or a control character; write it on one line"),
        ("[[rules]]", "[rules]", "mine.toml: rules: got {"),
        (HEAD, HEAD + "overlay = 1\n", "mine.toml: overlay: got 1; give true or false"),
        (HEAD, HEAD + 'not_assessed = "all"\n', "mine.toml: not_assessed: got 'all'; give a list of texts in quotes"),
        (HEAD, HEAD + "not_assessed = [1]\n", "mine.toml: rule set my-city: not_assessed: give a text"),
        (RULE, "rules = []", "mine.toml: rule set my-city: has no rule; give at least one"),
        (RULE, RULE + RULE, "mine.toml: rule set my-city: rule riser is there twice; rename or remove one"),
        ('clause = "4.2"\n', 'clause = "4.2"\nclause = "4.3"\n', "mine.toml: is not valid TOML"),
        ('"4.2"', '"4.2', "mine.toml: is not valid TOML"),
        ('grade = "P"', 'grade = "P"\nonly_where = 3', "only_where: got 3; write it as { quantity = 'going'"),
        ('grade = "P"', 'grade = "P"\nonly_where = {quantity = "going"}', "only_where: below is missing; add it"),
        (
            'grade = "P"',
            'grade = "P"\nonly_where = {quantity = "going", bellow = "1 m"}',
            "only_where: unknown key 'bellow'; did you mean 'below'?",
        ),
        (
            'grade = "P"',
            'grade = "P"\nonly_where = {quantity = "going", below = "42 deg"}',
            "only_where: 42° is no limit of going",
        ),
        (
            'grade = "P"',
            'grade = "P"\nonly_where = {quantity = "going", below = 11}',
            "only_where: got 11; write the limit in quotes",
        ),
    ],
)
def test_a_broken_file_is_told_in_one_sentence(old, new, message):
    assert TEXT.count(old) >= 1
    with pytest.raises(ConfigError) as caught:
        parse(TEXT.replace(old, new, 1))
    assert message in str(caught.value)
    assert str(caught.value).startswith("mine.toml: ")
    assert "\n" not in str(caught.value) or "valid TOML" in str(caught.value)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"\xff\xfe\x00", "mine.toml: is not a text file; give a TOML file"),
        (b"\x00" * 10, "mine.toml: is not valid TOML"),
        (b"# " + b"x" * 300_001, "mine.toml: larger than 300 kB, which no rule file is"),
        (b"[rules]\n" + b"a." * 5000 + b"a = 1", "mine.toml: line 2: a key of more than 50 parts; give a shorter one"),
        (b"a." * 100_000 + b"a = 1", "mine.toml: line 1: a key of more than 50 parts"),
        (b'"\\"" . ' * 60 + b"a = 1", "mine.toml: line 1: a key of more than 50 parts"),
        (b"rules = " + b"[" * 300 + b"]" * 300, "mine.toml: "),
        (b"", "mine.toml: id is missing; add it"),
        ("name = 'ü'".encode("latin-1"), "mine.toml: is not a text file"),
    ],
)
def test_what_is_no_rule_file(data, message):
    with pytest.raises(ConfigError, match=message):
        parse_rule_set(data, "mine.toml")


@pytest.mark.parametrize(
    "data",
    [b"a." * 140_000 + b"a = 1", b'"\\"' * 70_000, b"'." * 140_000, b'"' * 290_000, b"a" * 290_000, b"a . " * 70_000],
    ids=["dotted", "escaped quotes", "open quotes", "quotes", "one word", "spaces"],
)
def test_a_file_made_to_be_slow_is_refused_soon(data):
    start = time.perf_counter()
    with pytest.raises(ConfigError):
        parse_rule_set(data, "mine.toml")
    assert time.perf_counter() - start < 3.0


def test_a_mark_of_the_byte_order_is_no_part_of_the_text():
    data = b"\xef\xbb\xbf" + TEXT.encode()
    assert parse_rule_set(data, "mine.toml").rules == parse(TEXT).rules
    assert parse_rule_set(data, "mine.toml").sha256 == hashlib.sha256(data).hexdigest()


@pytest.mark.parametrize("name", ["a\x1b[2Jb.toml", "a\u202elmot.toml", "a\nb.toml"])
def test_the_name_of_a_file_is_no_way_to_the_terminal(name, tmp_path):
    for read in (lambda: parse_rule_set(TEXT.encode(), name), lambda: find_rule_set(str(tmp_path / name))):
        with pytest.raises(ConfigError, match="its name holds a control character; rename the file") as caught:
            read()
        assert str(caught.value).isprintable()


def test_a_changed_copy_does_not_pass_for_the_set_that_it_was():
    data = (static_configs() / "codes" / "us-irc-2024.toml").read_bytes()
    assert parse_rule_set(data, "mine.toml").is_shipped
    other = data.replace(b'"7 3/4 in"', b'"9 in"')
    with pytest.raises(ConfigError) as caught:
        parse_rule_set(other, "mine.toml")
    assert str(caught.value) == (
        "mine.toml: the id 'us-irc-2024' is that of a set that comes with the program; give the file another id"
    )
    renamed = parse_rule_set(other.replace(b'"us-irc-2024"', b'"my-town"'), "mine.toml")
    assert not renamed.is_shipped
    assert renamed.edited_words.startswith("user's own file, not a set that comes with the program")
    assert all(each.is_shipped and each.edited_words == "no" for each in list_rule_sets())


def test_a_value_nested_deeper_than_python_shows_is_told_all_the_same():
    nested: object = 1
    for _ in range(5000):
        nested = {"a": nested}
    assert brief(nested) == "a dict nested too deeply to be shown"


def test_too_many_rules():
    many = HEAD + "".join(RULE.replace('"riser"', f'"r{k}"', 1) for k in range(1001))
    with pytest.raises(ConfigError, match=r"mine\.toml: holds 1001 rules; the most are 1000"):
        parse(many)


def test_an_unknown_name_gets_the_nearest():
    with pytest.raises(ConfigError, match="rules: unknown rule set 'us-irc-2025'; did you mean 'us-irc-202"):
        find_rule_set("us-irc-2025")
    with pytest.raises(ConfigError, match=r"nowhere\.toml: cannot be read \(No such file or directory\)"):
        find_rule_set("nowhere.toml")


@pytest.mark.parametrize("name", ["../codes/us-irc-2024", "/etc/passwd", "..\\x"])
def test_a_name_does_not_lead_elsewhere(name):
    """A path is read as the file that it names, never as a shipped set."""
    assert str(rule_set_path(name)) == name
    with pytest.raises(ConfigError):
        find_rule_set(name)


@given(data=st.binary(max_size=400))
def test_any_bytes_are_a_set_or_a_sentence(data):
    with pytest.raises(ConfigError):
        parse_rule_set(data, "mine.toml")


@given(
    key=st.sampled_from(["id", "clause", "quantity", "statistic", "minimum", "severity", "from_scan", "only_where"]),
    value=st.sampled_from(["1", "1.5", "true", "[]", "[[]]", "{}", "''", '"\\u0000"', "1979-05-27", "inf"]),
)
def test_any_value_of_another_type_is_refused_with_a_sentence(key, value):
    lines = [line for line in RULE.splitlines() if not line.startswith(f"{key} =")]
    with pytest.raises(ConfigError, match=r"^mine\.toml: "):
        parse(HEAD + "\n".join([*lines, f"{key} = {value}"]) + "\n")
