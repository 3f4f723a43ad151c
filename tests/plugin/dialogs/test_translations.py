"""The template of translations holds every text of the plugin; needs no QGIS."""

import importlib.util
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]


@pytest.fixture(scope="module")
def translations():
    spec = importlib.util.spec_from_file_location(
        "translations", ROOT / "scripts" / "translations.py"
    )
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_template_is_up_to_date(translations):
    stored = translations.TEMPLATE.read_text(encoding="utf-8")
    assert stored == translations.template(), "run: python3 scripts/translations.py"


def translations_of(translations):
    paths = sorted(translations.TEMPLATE.parent.glob("terrain_wavelets_*.ts"))
    assert paths, "there is no translation"
    return {path.stem.rpartition("_")[2]: path.read_text(encoding="utf-8") for path in paths}


def test_translations_are_up_to_date_and_nearly_whole(translations):
    for language, stored in translations_of(translations).items():
        known = translations.translated(stored)
        assert stored == translations.template(known, language), "run scripts/translations.py"
        n_texts = sum(map(len, translations.all_strings().values()))
        assert len(known) >= 0.95 * n_texts, f"{language}: {n_texts - len(known)} to translate"


def test_a_translation_keeps_what_is_filled_in_and_the_tags(translations):
    for stored in translations_of(translations).values():
        for text, translation in translations.translated(stored).items():
            marks = [sorted(re.findall(r"\{[^}]*\}|<[^>]*>", t)) for t in (text, translation)]
            assert marks[0] == marks[1], text


def test_the_context_is_the_plugins(translations):
    source = (ROOT / "plugin" / "ui" / "translation.py").read_text("utf-8")
    assert f'CONTEXT = "{translations.CONTEXT}"' in source


def test_a_text_put_together_at_run_time_is_seen(translations):
    assert translations.strings_of("tr('a'); self.tr('b')", "m.py") == ["a", "b"]
    with pytest.raises(ValueError, match=r"m\.py:1"):
        translations.strings_of("tr('a' + name)", "m.py")
