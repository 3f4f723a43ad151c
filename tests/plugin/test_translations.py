"""The template of translations holds every text of the plugin; needs no QGIS."""

import importlib.util
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent.parent


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


def test_the_context_is_the_plugins(translations):
    source = (ROOT / "plugin" / "ui" / "translation.py").read_text("utf-8")
    assert f'CONTEXT = "{translations.CONTEXT}"' in source


def test_a_text_put_together_at_run_time_is_seen(translations):
    assert translations.strings_of("tr('a'); self.tr('b')", "m.py") == ["a", "b"]
    with pytest.raises(ValueError, match=r"m\.py:1"):
        translations.strings_of("tr('a' + name)", "m.py")
