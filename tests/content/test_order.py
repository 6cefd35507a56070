"""What a report holds: everything that a stair survey report is expected to, and nothing that it must not say."""

import dataclasses
import re

import pytest

from stair_inspector.codes import Limit, check, edited, overlaid
from stair_inspector.codes.rules import Condition
from stair_inspector.content.document import Facts, Figure, KeyFigures, Paragraph, Signatures, Status, Table
from stair_inspector.content.fields import Checklist, ReportBasis, ReportFields
from stair_inspector.content.images import Photo
from stair_inspector.content.note_words import note_words
from stair_inspector.content.rule_tables import by_step_table, results_table
from stair_inspector.content.uncertainty_words import uncertainty_sentences
from stair_inspector.content.wording import (
    changed_limits_sentence,
    limitation_sentences,
    outside_sentences,
    result_sentence,
    verdict_of,
)
from stair_inspector.files.rule_sets import find_rule_set, list_rule_sets
from stair_inspector.model import Note
from stair_inspector.params import Params, UncertaintyParams
from stair_inspector.pipeline import inspect
from stair_inspector.writers.text import check_text
from tests.codes import test_rules as made_up
from tests.codes.flights import changed, even, flight_of, inspection_of, measured
from tests.synthetic import Stair, exact_params
from tests.writers.samples import (
    BASIS,
    HOSTILE,
    MADE_AT,
    by_the_paper,
    checked,
    document,
    html_page,
    plain_document,
    scanned,
    workbook,
)

BANNED = re.compile(
    r"compliant|complies|compliance|\blegal(ly)?\b|violat|\bpass(es|ed)?\b|\bfail(s|ed|ure)?\b", re.IGNORECASE
)


def text_of(made):
    return html_page(made).text


def front_text(made):
    """The words of the first page."""
    return " ".join(block.text for block in made.front if isinstance(block, Paragraph))


def table_of(made, key):
    return next(table for table in made.tables() if table.key == key)


def facts_of(made):
    found = dict(made.identity)
    for block in made.blocks():
        if isinstance(block, Facts):
            found |= dict(block.items)
        elif isinstance(block, Signatures):
            found |= {f"{role}: {label}": value for role, lines in block.items for label, value in lines}
    return found


@pytest.mark.parametrize("name", [field.name for field in dataclasses.fields(ReportFields)])
def test_every_field_of_the_user_is_in_the_report_and_empty_it_is_a_blank(name):
    filled = plain_document(scanned()[1], None, ReportBasis(fields=ReportFields(**{name: "given by the user"})))
    label = {"reviewed_by": "Name", "reviewed_on": "Date"}.get(name, ReportFields.label_of(name))
    facts = {**facts_of(filled), "Title": facts_of(filled).get("Title") or filled.title}
    assert any(value == "given by the user" for key, value in facts.items() if key.split(": ")[-1] == label)
    blank = facts_of(plain_document(scanned()[1]))
    assert any(key.split(": ")[-1] == label for key in blank)


def test_a_report_without_fields_has_blanks_and_no_invention():
    facts = facts_of(plain_document(scanned()[1]))
    for name in (field.name for field in dataclasses.fields(ReportFields)):
        assert facts.get(ReportFields.label_of(name), "") == ""


def test_the_scan_and_the_program_are_named():
    scan, inspection = scanned()
    facts = facts_of(document())
    assert facts["SHA-256"] == scan.sha256 == inspection.scan.sha256
    assert facts["Scan file"] == "defective_step.ply"
    assert facts["Points in the file"].replace("\u202f", "") == str(inspection.scan.n_points)
    assert facts["Unit of the file"] == "m"
    assert "normal of the floor" in facts["Up vector"]
    assert facts["Software"].startswith("stair_inspector ")


def test_every_setting_is_listed_and_changed_ones_are_marked():
    _, inspection = scanned()
    rows = table_of(document(), "settings").rows
    names = {row[0] for row in rows}
    groups = dataclasses.asdict(Params())
    expected = {name for name, value in groups.items() if not isinstance(value, dict)}
    expected |= {f"{group}.{name}" for group, value in groups.items() if isinstance(value, dict) for name in value}
    assert names == expected
    for row in rows:
        is_changed = inspection.params.value(row[0]) != Params().value(row[0])
        assert (row[-1] == "changed") == is_changed


def test_what_the_inspector_overruled_is_listed_with_its_reason():
    force = "level:2=rejected (a box; see <photo>)"
    inspection = inspect(Stair(n_steps=3).scan(), exact_params().replaced("overrules.force", force))
    rows = table_of(plain_document(inspection), "overrules").rows
    assert rows == (("level 2", "rejected", "a box; see <photo>"),)


def test_an_edited_rule_set_says_so():
    rules = edited(find_rule_set("us-ibc-2021"), "riser", "maximum", Limit.of("8", "in"), "approved by the city")
    made = plain_document(scanned()[1], check(scanned()[1], rules))
    assert facts_of(made)["Edited by the user"] == "yes"
    assert table_of(made, "edits").rows[0][-1] == "approved by the city"
    said = [
        sentence for sentence in limitation_sentences(scanned()[1], check(scanned()[1], rules)) if "user" in sentence
    ]
    assert len(said) == 1
    assert said[0].startswith(
        "Limits are those of the rule file named above, but for 1 that the user has changed and that this report lists;"
    )
    plain_one = document()
    assert facts_of(plain_one)["Edited by the user"] == "no"
    own = dataclasses.replace(find_rule_set("us-ibc-2021"), is_shipped=False)
    made = plain_document(scanned()[1], check(scanned()[1], own))
    assert facts_of(made)["Edited by the user"].startswith("user's own file, not a set that comes with the program")


def test_the_rule_set_its_file_and_hash_are_named():
    facts = facts_of(document())
    rules = checked().rule_set
    assert facts["SHA-256 of the file"] == rules.sha256
    assert (facts["Id"], facts["Edition"]) == ("us-ibc-2021", "2021")
    assert facts["Reference code"] == rules.title


def test_an_overlay_is_named_and_its_rules_are_judged():
    rules = overlaid(find_rule_set("us-ibc-2021"), find_rule_set("us-nfpa-101-uniformity"))
    made = plain_document(scanned()[1], check(scanned()[1], rules))
    assert "us-nfpa-101-uniformity" in facts_of(made)["Overlays"]
    assert any("7.2.2.3.6" in str(row[0]) for row in table_of(made, "rules").rows)


def test_the_tables_of_a_survey_report_are_there_with_their_columns():
    made = document()
    expected = {
        "flights": {"Risers", "Total rise", "Total run", "Mean rise", "Mean going", "Pitch", "Tread width"}
        | {"Range of rise", "Largest change of rise", "Between steps"},
        "steps": {"Step", "Rise", "Going", "Tread depth", "Overhang", "Width", "2R + G", "Pitch", "Diagonal", "U rise"},
        "evidence": {"Fall", "Cross-fall", "Rise left", "Rise centre", "Rise right", "Points", "Coverage", "Plane RMS"}
        | {"Flags"},
        "uniformity": {"n", "Mean", "SD", "Smallest", "Largest", "Range", "Largest difference of neighbours"},
        "rules": {"Clause", "What is limited", "Limit as written", "Measured", "Margin", "U", "Result"},
        "closure": {"Sum of rises", "Plane to plane", "Difference", "Result"},
        "readings": {"By hand", "Scan", "Difference", "Result"},
        "fits": {"Fit for this check?", "Largest U", "Tolerance", "Source"},
        "checklist": {"Item", "Seen on site"},
    }
    for key, names in expected.items():
        assert names <= {column.name for column in table_of(made, key).columns}, key


def test_the_pictures_and_drawings_are_there():
    keys = [figure.key for figure in document().figures()]
    for start in ("raw_", "segmented_", "residuals", "rise_", "going_", "nosing_line_", "plan_", "section_"):
        assert any(key.startswith(start) for key in keys), start
    assert len(keys) == len(set(keys))


def test_photos_of_the_site_are_shown_with_their_captions():
    basis = ReportBasis(photos=(Photo(b"data", "from below"), Photo(b"data")))
    figures = [block for block in plain_document(scanned()[1], None, basis).blocks() if isinstance(block, Figure)]
    assert [figure.caption for figure in figures] == ["Photograph 1: from below", "Photograph 2"]


def test_items_that_no_scan_shows_are_listed_as_not_assessed():
    rows = {row[0]: row[1] for row in table_of(document(), "checklist").rows}
    for item in ("Slip resistance", "Lighting", "Contrast", "Handrails", "Headroom"):
        assert any(label.startswith(item) and cell.words == "not assessed" for label, cell in rows.items())
    text = text_of(document())
    for sentence in checked().not_assessed:
        assert sentence in text


def test_the_uncertainty_is_stated_in_words():
    text = " ".join(uncertainty_sentences(scanned()[1]))
    for words in (
        "k = 2",
        "about 95 %",
        "JCGM 100",
        "RMS of a plane is not its accuracy",
        "type A",
        "LOA50",
        "vertical",
    ):
        assert words in text
    assert "0.1 mm of registration" in text


def test_nothing_stated_about_the_scanner_is_said_to_be_missing():
    text = " ".join(uncertainty_sentences(inspection_of(even(3, u=0.0004))))
    assert "Nothing was stated about the scanner" in text
    assert "The true uncertainty is larger" in text
    assert "taken as exact" in text


def stating(inspection, **stated):
    return dataclasses.replace(inspection, params=Params(uncertainty=UncertaintyParams(**stated)))


def test_what_was_not_stated_about_the_scanner_is_listed():
    text = " ".join(uncertainty_sentences(stating(inspection_of(even(3, u=0.0004)), scale_percent=0.01)))
    assert "0.01 % of scale" in text
    assert "Not stated: registration from one step to the next, the rounding of edges, levelling." in text
    assert "The true uncertainty is larger" in text
    complete = {"registration_m": 0.0001, "edge_m": 0.0005, "up_deg": 0.01, "scale_percent": 0.01}
    text = " ".join(uncertainty_sentences(stating(inspection_of(even(3, u=0.0004)), **complete)))
    assert "ot stated" not in text.partition("Stated about the scanner")[2]
    assert "true uncertainty is larger" not in text


def test_no_level_of_accuracy_is_claimed_of_a_scan_about_which_nothing_was_stated():
    inspection = inspection_of(even(3, u=0.0004))
    for nothing in (inspection, stating(inspection, scale_percent=0.01)):
        assert "LOA" not in " ".join(uncertainty_sentences(nothing))
    assert "LOA50" in " ".join(uncertainty_sentences(stating(inspection, edge_m=0.0005)))


def test_how_well_the_floor_was_fitted_is_not_how_level_it_is():
    inspection = inspection_of(even(4))
    for source, words in (("floor", "whether the floor is level"), ("treads", "whether the treads are level")):
        up = dataclasses.replace(inspection.up, source=source, u_deg=0.01)
        text = " ".join(uncertainty_sentences(dataclasses.replace(inspection, up=up)))
        assert f"taken from the {source}, the normal of which was found to ± 0.01° (k = 2); {words} was not" in text
        assert "is known to" not in text
        text = " ".join(uncertainty_sentences(stating(dataclasses.replace(inspection, up=up), up_deg=0.1)))
        assert "with what was stated about it U takes it as known to ± 0.2° (k = 2)" in text


def test_values_without_an_uncertainty_are_not_said_to_have_one():
    text = " ".join(uncertainty_sentences(inspection_of(even(4, u=0.0004))))
    assert "Every value" not in text
    assert "Means, ranges, values on the single lines" in text
    assert text.count("built into the program") == 2
    assert "half the interval in which a hidden back edge lies" in text


def test_the_papers_method_has_a_text_of_its_own_on_uncertainty():
    inspection = by_the_paper()
    text = " ".join(uncertainty_sentences(inspection))
    assert "given without an uncertainty" in text
    for words in ("±", "k = 2", "LOA", "type A"):
        assert words not in text


GRAVE_NOTES = (
    ("up_disagree", "floor and treads disagree about the vertical by 2.5°; give --up if you know it", None),
    ("treads_lean", "the treads on the whole lean by 1.20° from the horizontal", None),
    ("unit_guessed", "unit guessed: metres, which makes the scan 7.3 m in size; state the unit", None),
    ("side_unobserved", "a side of step 2 was not seen", 2),
    ("side_unobserved", "a side of step 4 was not seen", 4),
)


def test_the_gravest_notes_are_limitations_and_belong_to_the_accuracy():
    inspection = inspection_of(even(5), notes=GRAVE_NOTES)
    for sentences in (limitation_sentences(inspection, None), uncertainty_sentences(inspection)):
        assert "Floor and treads disagree about the vertical by 2.5°." in sentences
        assert "The treads on the whole lean by 1.20° from the horizontal." in sentences
        text = " ".join(sentences)
        assert "The unit of the scan was guessed: metres, which makes the scan 7.3 m in size" in text
        assert "Step 2 and 4: a side was not seen" in text


ADVISED = (
    ("what it adds is not stated: choose the scanner's preset, or set uncertainty.*", "what it adds is not stated"),
    ("unit guessed: metres; if that is wrong, state the unit with --unit", "unit guessed: metres"),
    (
        "a ceiling, which serves as well; give --up -z if the scan's z axis points down",
        "a ceiling, which serves as well",
    ),
    ("one level; check the up direction, then theta_th, eps_z and m", "one level"),
    ("one spans 900 mm, so several have run together: lower eps_z or raise m, and check it", "one spans 900 mm"),
    ("may be exchanged; try another axes rule", "may be exchanged"),
    ("step 3 has no rise: no floor was seen; a second part", "step 3 has no rise: no floor was seen; a second part"),
)


@pytest.mark.parametrize(("message", "words"), ADVISED)
def test_a_note_is_printed_without_its_advice_on_the_program(message, words):
    made = plain_document(inspection_of(even(3), notes=[("x", message, None)]))
    assert table_of(made, "notes").rows[0][-1] == words


def test_no_note_of_a_scan_speaks_of_the_programs_options():
    empty = dataclasses.replace(
        inspection_of(even(1)),
        steps=(),
        flights=(),
        notes=(Note("no_staircase", "verdict", "no staircase found: 2 levels; check the up direction, eps_z and m"),),
    )
    assert result_sentence(empty, None) == "No staircase found: 2 levels."
    for made in (plain_document(inspect(Stair(n_steps=3).scan(), Params())), plain_document(empty)):
        text = text_of(made)
        for words in ("--up", "--unit", "uncertainty.*", "check the up direction"):
            assert words not in text


def test_the_same_findings_are_counted_alike_in_the_summary_and_the_table():
    steps = even(8, rise=measured(0.178, 0.0005))
    for number in (3, 5):
        steps = changed(steps, number, rise_m=measured(0.18, 0.0005))
    inspection = inspection_of(steps)
    found = check(inspection, find_rule_set("us-ibc-2021"))
    counts = "2 outside, 6 outside by less than U"
    assert f"of this rule {counts}" in outside_sentences(found)[0]
    row = table_of(plain_document(inspection, found), "rules").rows[0]
    assert f"8: {counts}" in row


def test_a_value_just_outside_is_not_said_to_be_outside_by_nothing():
    found = check(inspection_of(even(4, rise=measured(0.177801, 0.0005))), find_rule_set("us-ibc-2021"))
    assert "by less than 0.01 mm, by less than U" in outside_sentences(found)[0]
    made = plain_document(inspection_of(even(4)), found)
    for key in ("rules", "findings"):
        table = table_of(made, key)
        margin = next(k for k, column in enumerate(table.columns) if column.name == "Margin")
        assert table.columns[margin].text(table.rows[0][margin]) == "−0.001"


@pytest.mark.parametrize(
    ("u", "shown"), [(0.0, "190.00"), (0.00004, "190.00 ± 0.04"), (0.0002, "190.0 ± 0.2"), (0.012, "190 ± 12")]
)
def test_a_value_and_its_uncertainty_are_rounded_to_the_same_place(u, shown):
    inspection = inspection_of(changed(even(4), 2, rise_m=measured(0.19, u)))
    found = check(inspection, find_rule_set("us-ibc-2021"))
    assert f"riser height is {shown} mm" in outside_sentences(found)[0]
    table = table_of(plain_document(inspection, found), "rules")
    cells = {column.name: column.text(cell) for column, cell in zip(table.columns, table.rows[0], strict=True)}
    assert f"{cells['Measured']} ± {cells['U']}".removesuffix(" ± 0") == shown


def test_the_dimensions_of_a_step_are_rounded_where_their_uncertainty_is():
    steps = changed(even(4), 2, rise_m=measured(0.19012, 0.00004), width_m=measured(1.6012, 0.012))
    table = table_of(plain_document(inspection_of(steps)), "steps")
    cells = {column.name: column.text(cell) for column, cell in zip(table.columns, table.rows[1], strict=True)}
    assert (cells["Rise"], cells["U rise"]) == ("190.12", "0.04")
    assert (cells["Width"], cells["U width"]) == ("1601", "12")
    assert cells["Going"] == "290.0"


def test_one_reason_for_all_rules_is_told_once():
    inspection = by_the_paper()
    made = plain_document(inspection, check(inspection, find_rule_set("us-ibc-2021")))
    table = table_of(made, "findings")
    assert table.rows == ()
    assert table.empty.endswith("could be judged: the paper's method measures nothing from nosing to nosing.")
    keys = {each.key for each in made.tables()}
    assert not {"by_step", "fits"} & keys
    assert text_of(made).count("could be judged: the paper's method measures nothing from nosing to nosing") == 1
    assert "method survey" not in text_of(made)


def test_what_was_not_measured_is_no_limitation():
    paper = by_the_paper()
    assert not any("three lines" in sentence for sentence in limitation_sentences(paper, None))
    assert any("three lines" in sentence for sentence in limitation_sentences(scanned()[1], None))


def test_the_summary_has_range_and_largest_change_of_the_goings():
    inspection = scanned()[1]
    table = table_of(document(), "flights")
    rows = [dict(zip((column.name for column in table.columns), row, strict=True)) for row in table.rows]
    for row, flight in zip(rows, inspection.flights, strict=True):
        assert row["Range of going"] == pytest.approx(1000.0 * flight.going.range)
        assert row["Largest change of going"] == pytest.approx(1000.0 * flight.going.max_adjacent)
        assert row["Between these steps"] == "{} and {}".format(*flight.going.at)


def test_a_tilt_is_told_in_millimetres_of_rise():
    inspection = inspection_of(even(4))
    tilted = dataclasses.replace(inspection, up=dataclasses.replace(inspection.up, source="floor", u_deg=1.0))
    text = " ".join(uncertainty_sentences(tilted))
    # 290 mm times the sine of a degree, and its tangent.
    assert "shifts every rise by 5.1 mm" in text
    assert "every slope by 1.7 %" in text


@pytest.mark.slow
@pytest.mark.parametrize("rules", [each.set_id for each in list_rule_sets()])
def test_no_report_passes_a_legal_judgement(rules):
    own = find_rule_set(rules)
    for name in ("defective_step", "straight"):
        made = plain_document(scanned(name)[1], check(scanned(name)[1], own))
        texts = text_of(made)
        for quoted in (own.source, *own.not_assessed, *(rule.term for rule in own.rules)):
            texts = texts.replace(quoted, "")
        assert BANNED.findall(texts) == []


def test_an_outside_value_is_told_with_clause_and_edition():
    steps = changed(even(4), 2, rise_m=measured(0.19, 0.0002))
    found = check(inspection_of(steps), find_rule_set("us-ibc-2021"))
    first = outside_sentences(found)[0]
    assert first == (
        "Flight 1, step 2: riser height is 190.0 ± 0.2 mm, outside the limit 7 in (177.8 mm) listed in 1011.5.2, "
        "International Building Code, 2021, by 12.20 mm."
    )


def test_an_outside_value_that_is_close_says_so():
    found = check(inspection_of(even(4, rise=measured(0.178, 0.0005))), find_rule_set("us-ibc-2021"))
    assert outside_sentences(found)[0].endswith(
        "by 0.20 mm, by less than U; of this rule 4 outside by less than U, this is the gravest."
    )
    assert verdict_of(found).tone == "close"


def test_a_check_in_which_all_is_within_says_no_more_than_that():
    found = check(inspection_of(even(6, width=1.3)), find_rule_set("us-ibc-2021"))
    assert verdict_of(found).words == "measured values within limits"
    made = plain_document(inspection_of(even(6, width=1.3)), found)
    assert "nothing that was measured is outside a limit" in text_of(made).lower()


def test_what_was_not_measured_is_not_within():
    steps = changed(even(6, width=1.3), 1, rise_m=None)
    found = check(inspection_of(steps), find_rule_set("us-ibc-2021"))
    assert verdict_of(found).tone == "close"
    assert any(
        row[-2].words == "not measured"
        for row in table_of(plain_document(inspection_of(steps), found), "findings").rows
    )


def test_a_rule_that_does_not_apply_leaves_nothing_open():
    # The dwelling set limits nosings where treads are shallower than 11 in; these are deeper.
    found = check(scanned("straight")[1], find_rule_set("us-ibc-2021-dwelling"))
    assert any(finding.verdict.words == "not judged" for finding in found.findings)
    assert verdict_of(found).words == "measured values within limits"


def test_a_report_without_rules_says_that_none_were_applied():
    made = plain_document(scanned()[1])
    assert "no rule set was applied" in text_of(made)
    assert not any(section.title == "Check against the rule set" for section in made.sections)
    assert not any(isinstance(block, KeyFigures) and block.status for block in made.blocks())


def test_what_a_clause_asks_for_without_a_number_keeps_the_result_from_being_good():
    """A riser 15 mm too high is inside every limit of a code that says uniform and gives no number."""
    found = checked("defective_step", "us-osha-1910-25")
    assert verdict_of(found) == Status(
        "measured values within limits; uniformity is for the inspector to judge", "close"
    )
    words = front_text(plain_document(scanned()[1], found))
    assert (
        "1910.25(b)(3) gives no number for uniform riser heights between landings: 15.1 ± 0.5 mm, steps 4 and 5"
        in words
    )


def test_a_limit_given_to_a_clause_without_a_number_is_judged_on_the_first_page():
    rules = find_rule_set("us-osha-1910-25")
    for rule_id in ("riser-uniformity", "tread-uniformity"):
        rules = edited(rules, rule_id, "maximum", Limit.of("5", "mm"), "the city's")
    found = check(scanned("defective_step")[1], rules)
    assert verdict_of(found) == Status("values outside limits; 2 limits changed by the user", "bad")
    sentence = next(each for each in outside_sentences(found) if "riser" in each)
    assert "outside the limit 5 mm set by the user where the code has none, " in sentence
    assert "listed" not in sentence


def test_a_reported_value_beyond_the_number_of_its_clause_keeps_the_result_from_being_good():
    """Thirty risers without a landing, where the code has one every 12 ft."""
    high = inspection_of(even(30, 0.0002, rise=0.17, going=0.29))
    found = check(high, find_rule_set("us-ibc-2024"))
    assert verdict_of(found) == Status(
        "measured values within limits; values beyond a number that is reported only are for the inspector to judge",
        "close",
    )
    words = front_text(plain_document(high, found))
    assert "5100.0 ± " in words
    assert "12 ft (3657.6 mm), which is reported only and for the inspector to judge" in words
    low = check(inspection_of(even(6, 0.0002, rise=0.17, going=0.29)), find_rule_set("us-ibc-2024"))
    assert verdict_of(low) == Status("measured values within limits", "good")
    # Also where nothing else is judged.
    alone = dataclasses.replace(found.rule_set, rules=(found.rule_set.rule("flight-rise"),))
    assert verdict_of(check(high, alone)).tone == "close"


def test_the_mark_of_an_edited_limit_is_explained_where_it_stands():
    found = with_a_changed_riser("180", "mm")
    tables = {table.key: table.note for table in (results_table(found), by_step_table(scanned()[1], found))}
    assert set(tables) == {"rules", "by_step"}
    for note in tables.values():
        assert note.endswith(
            "(edited): changed by the user, and not a limit of the clause; 'Limits edited by the user' has both."
        )
    assert "(edited)" not in results_table(checked()).note


def test_of_many_changed_limits_the_first_page_names_some_and_counts_the_others():
    rules = find_rule_set("us-ibc-2024")
    sized = [rule for rule in rules.rules if rule.maximum is not None and rule.maximum.unit == "in"]
    sides = [(rule, "maximum") for rule in sized]
    sides += [(rule, "minimum") for rule in rules.rules if rule.minimum is not None and rule.minimum.unit == "in"]
    assert len(sides) >= 6
    for rule, side in sides[:6]:
        size = float(getattr(rule, side).exact) * 1000.0
        rules = edited(rules, rule.rule_id, side, Limit.of(f"{size * 1.01:.3f}", "mm"), "agreed")
    sentence = changed_limits_sentence(check(inspection_of(even(6)), rules))
    assert sentence.count(" in place of ") == 4
    assert "; and 2 more. The reasons stand under" in sentence


def test_values_nearer_to_a_limit_than_u_keep_the_result_from_being_good():
    close = inspection_of(even(6, width=1.3, rise=measured(0.1776, 0.0005)))
    found = check(close, find_rule_set("us-ibc-2021"))
    assert verdict_of(found) == Status("measured values within limits; 6 nearer to a limit than U", "close")
    assert "6 values are within, but nearer to a limit than U" in front_text(plain_document(close, found))


def test_values_outside_what_is_advised_keep_the_result_from_being_good():
    advice = made_up.rule("advice", maximum=Limit.of("150", "mm"), minimum=None, severity="advisory")
    limit = made_up.rule("limit", maximum=Limit.of("200", "mm"), minimum=None)
    found = check(inspection_of(even(6)), made_up.rule_set(limit, advice))
    assert verdict_of(found) == Status("measured values within limits; values outside what is advised", "close")
    # Advice alone is no limit that something could be within.
    alone = check(inspection_of(even(6)), made_up.rule_set(advice))
    assert verdict_of(alone) == Status("nothing could be judged; values outside what is advised", "plain")


def test_nothing_is_good_where_nothing_was_judged():
    nowhere = made_up.rule("nosing", quantity="nosing_overhang", only_where=Condition("going", Limit.of("250", "mm")))
    found = check(inspection_of(even(6)), made_up.rule_set(nowhere))
    assert not any(finding.is_open for finding in found.findings)
    assert verdict_of(found) == Status("nothing could be judged", "plain")


def with_a_changed_riser(written, unit):
    rules = edited(find_rule_set("us-ibc-2024"), "riser", "maximum", Limit.of(written, unit), "city amendment")
    return check(scanned()[1], rules)


def test_a_limit_that_the_user_has_set_is_never_said_to_be_the_codes():
    """Wherever the limit stands, it is marked: 180 mm is in no edition of the code."""
    found = with_a_changed_riser("180", "mm")
    made = plain_document(scanned()[1], found)
    sentence = outside_sentences(found)[0]
    assert "outside the limit 180 mm set by the user in place of 7 in (177.8 mm), 1011.5.2" in sentence
    assert "listed" not in sentence
    assert verdict_of(found) == Status("values outside limits; 1 limit changed by the user", "bad")
    changed_limit = "riser height, maximum 180 mm in place of 7 in (177.8 mm) (1011.5.2)"
    assert changed_limit in front_text(made)
    row = next(row for row in table_of(made, "rules").rows if row[1] == "riser height")
    assert row[2] == "4 in (101.6 mm) to 180 mm (edited)"
    assert "180 mm (edited)" in table_of(made, "by_step").columns[1].unit
    assert table_of(made, "findings").rows[0][-1] == "maximum 180 mm, set by the user"
    assert facts_of(made)["Reference code"].endswith("; 1 limit changed by the user")
    book = workbook(made)
    cells = [str(cell.value) for sheet in book for row in sheet.iter_rows() for cell in row if cell.value is not None]
    for told in (text_of(made), *cells, check_text(found)):
        for place in re.finditer("180 mm", told):
            about = told[max(0, place.start() - 60) : place.end() + 45]
            assert (
                re.search(r"edited|set by the user|the user's|in place of|city amendment|became", about)
                or about == "180 mm"
            )


def test_a_limit_changed_until_all_is_within_is_told_on_the_first_page():
    rules = edited(find_rule_set("us-ibc-2021"), "riser", "maximum", Limit.of("9", "in"), "as the owner wishes")
    steps = inspection_of(even(6, rise=0.2, width=1.3))
    found = check(steps, rules)
    assert verdict_of(found) == Status("measured values within limits; 1 limit changed by the user", "close")
    made = plain_document(steps, found)
    assert "riser height, maximum 9 in (228.6 mm) in place of 7 in (177.8 mm) (1011.5.2)" in front_text(made)
    assert "but for 1 that the user has changed" in text_of(made)
    back = edited(rules, "riser", "maximum", Limit.of("7", "in"), "after all")
    assert "changed" not in verdict_of(check(steps, back)).words
    # What is as in the file is no limitation of the report.
    assert not any("user" in sentence for sentence in limitation_sentences(steps, check(steps, back)))


def test_notes_of_the_check_are_without_the_words_of_the_command_line():
    inspection = inspection_of(
        even(4),
        notes=[
            ("uncertainty_unstated", "u holds less: choose the scanner's preset, or set uncertainty.*", None),
            ("up_disagree", "floor and treads disagree by 2°; give --up if you know it", None),
            ("chain_ambiguous", "patch 4 would also have been possible: overrule it if that is the step", None),
        ],
    )
    text = text_of(plain_document(inspection, check(inspection, find_rule_set("us-ibc-2021"))))
    assert "floor and treads disagree by 2°" in text
    for words in ("uncertainty.*", "--up", "preset", "overrule it"):
        assert words not in text


@pytest.mark.parametrize(
    ("message", "words"),
    [
        (
            "2 surfaces, but overrules.climb (x) leaves out 3 risers; correct overrules.climb, or set it to auto",
            "2 surfaces, but the direction of climb that was set (x) leaves out 3 risers",
        ),
        (
            "only 0.011 m² large, less than any tread (patches.min_area_m2 is 0.05)",
            "only 0.011 m² large, less than any tread (the least area that was set, m²: 0.05)",
        ),
    ],
)
def test_a_setting_is_named_in_words(message, words):
    assert note_words(message) == words


def test_the_summary_without_a_staircase_does_not_list_every_rule():
    empty = inspection_of([], [], notes=[("no_staircase", "no staircase found: one level", None)])
    made = plain_document(empty, check(empty, find_rule_set("us-ibc-2024")))
    assert not any(table.key == "rules" for table in made.tables())
    text = text_of(made)
    assert "None of the 11 rules and flights could be judged" not in text
    assert "us-ibc-2024 " not in front_text(made)


def test_no_staircase_is_an_answer_of_the_report():
    empty = dataclasses.replace(
        inspection_of(even(1)),
        steps=(),
        flights=(),
        notes=(Note("no_staircase", "verdict", "no staircase found: one level and nothing above it"),),
    )
    for found in (None, check(empty, find_rule_set("us-ibc-2021"))):
        made = plain_document(empty, found)
        text = text_of(made)
        assert "No staircase found: one level and nothing above it." in text
        assert "Sign-off" in text
        assert not any(table.key == "steps" for table in made.tables())


def test_a_winding_flight_is_reported_and_not_judged():
    steps = even(5)
    winding = inspection_of(steps, [flight_of(steps, shape="winder")])
    made = plain_document(winding, check(winding, find_rule_set("us-ibc-2021")))
    assert "Flight 1 winds" in text_of(made)
    assert {row[-1].words for row in table_of(made, "rules").rows} <= {"not judged", "not assessed"}


def test_the_report_says_that_a_flight_goes_on():
    steps = even(5)
    goes_on = "5 risers measured; about 6 more are seen above: their treads are hidden from the scanner"
    inspection = inspection_of(steps, [dataclasses.replace(flight_of(steps), goes_on=goes_on)])
    made = plain_document(inspection, check(inspection, find_rule_set("us-ibc-2021")))
    assert f"Flight 1 goes on: {goes_on}." in text_of(made)
    table = table_of(made, "flights")
    assert dict(zip((column.name for column in table.columns), table.rows[0], strict=True))["Goes on"] == goes_on


def test_the_radius_of_a_flight_that_curves_is_in_the_table_of_flights():
    steps = even(5)
    radius = measured(4.0123, 0.0121)
    curved = dataclasses.replace(flight_of(steps), shape="curved", radius_m=radius)
    table = table_of(plain_document(inspection_of(steps, [curved]), None), "flights")
    row = dict(zip(((column.name, column.is_u) for column in table.columns), table.rows[0], strict=True))
    assert row["Radius", False].value == pytest.approx(4012.3)
    assert next(column.unit for column in table.columns if column.name == "Radius") == "mm"
    plain = table_of(plain_document(inspection_of(steps, [flight_of(steps)]), None), "flights")
    assert not {"Radius", "Goes on"} & {column.name for column in plain.columns}


def test_of_a_curved_flight_the_report_says_on_which_line_it_was_measured():
    steps = even(5)
    curved = inspection_of(steps, [flight_of(steps, shape="curved")])
    made = plain_document(curved, check(curved, find_rule_set("us-ibc-2021")))
    assert "Flight 1 curves. Its goings are those along the arc" in text_of(made)
    assert "winds" not in text_of(made)


def test_the_papers_method_reports_its_own_quantities_and_judges_nothing():
    inspection = by_the_paper()
    made = plain_document(inspection, check(inspection, find_rule_set("us-ibc-2021")))
    assert len(table_of(made, "paper").rows) == len(inspection.steps)
    assert not any(table.key == "steps" for table in made.tables())
    assert "no limit of a code applies" in text_of(made)


def test_sections_are_numbered_without_a_gap_and_appendices_lettered():
    for made in (document(), plain_document(scanned()[1])):
        numbers = [section.number for section in made.sections]
        digits = [number for number in numbers if number.isdigit()]
        letters = [number for number in numbers if not number.isdigit()]
        assert digits == [str(k) for k in range(1, len(digits) + 1)]
        assert "".join(letters) == "ABCD"


def test_the_same_input_gives_the_same_document():
    _, inspection = scanned()
    assert plain_document(inspection, checked(), BASIS) == plain_document(inspection, checked(), BASIS)


def test_hostile_notes_and_names_reach_every_table_as_text():
    inspection = inspection_of(even(3), notes=[("x", HOSTILE, 2)])
    named = dataclasses.replace(inspection, scan=dataclasses.replace(inspection.scan, name=HOSTILE))
    made = plain_document(named, None, ReportBasis(checklist=Checklist(lighting=HOSTILE)))
    assert facts_of(made)["Scan file"] == HOSTILE
    assert table_of(made, "notes").rows[0][-1] == HOSTILE
    assert (Checklist.label_of("lighting"), HOSTILE) in table_of(made, "checklist").rows


def test_tables_know_their_number_of_columns():
    with pytest.raises(ValueError, match="row 0 has 1 cells for 2 columns"):
        Table("t", "T", document().tables()[0].columns[:2], (("a",),))


def test_the_date_is_the_one_given():
    assert document().made_at == MADE_AT
