"""Plan: feeds along the path of STEP-NC programs, and of NC code with its tools."""

from pathlib import Path

from playwright.sync_api import Locator, Page, expect

from tests.service.dashboard.conftest import PHONE, WIDE, keep, overflow
from tests.service.rest.samples import CODE, CODE_STOCK, CODE_TOOLS
from tests.service.waiting import until


def drawn(page: Page) -> Locator:
    """Lines of the plot of both runs."""
    return page.locator("#along-plot .scatterlayer .trace")


def test_code_is_chosen_with_its_tools_and_rewritten(page: Page, tmp_path: Path) -> None:
    (tmp_path / "plate.nc").write_bytes(CODE)
    (tmp_path / "plate.csv").write_bytes(CODE_TOOLS)
    page.goto("/dashboard/plan.html")
    expect(page.locator("#code-options")).to_be_hidden()
    page.locator("#program-file").set_input_files(tmp_path / "plate.nc")
    expect(page.locator("#program-shown")).to_contain_text("NC code for fanuc (mill")
    expect(page.locator("#moves")).to_contain_text("T1line4")
    expect(page.locator("#code-options")).to_be_visible()
    for name in ("nc-control", "along", "units"):
        expect(page.locator(f"#{name}")).to_be_hidden()
    hint = page.locator("#optimise-hint")
    expect(hint).to_have_text("NC code needs a tool table, the raw part, a material.")
    page.locator("#tools-file").set_input_files(tmp_path / "plate.csv")
    expect(page.locator("#tools-place")).to_contain_text("plate.csv")
    page.locator("#code-stock").fill(CODE_STOCK)
    page.locator("#material").select_option("c45")
    page.locator("#mark").check()
    page.locator("#optimise").click()
    expect(page.locator("#along-parts tbody tr")).to_have_count(1)
    expect(page.locator("#along-parts")).to_contain_text("T1")
    expect(page.locator("#along-shares")).to_contain_text("feed per tooth")
    expect(page.locator("#result-findings")).to_contain_text("4 blocks changed")
    expect(page.locator("#steps")).to_be_hidden()
    expect(drawn(page)).to_have_count(6)
    with page.expect_download() as code:
        page.locator("#download-nc").click()
    assert code.value.suggested_filename == "plate.optimised.nc"
    code.value.save_as(tmp_path / "new.nc")
    assert b"greatest rise" in (tmp_path / "new.nc").read_bytes()
    with page.expect_download() as feeds:
        page.locator("#download-feeds").click()
    assert feeds.value.suggested_filename == "plate.feeds.csv"
    keep(page, "plan-code")
    page.reload()
    expect(page.locator("#along-parts tbody tr")).to_have_count(1)
    expect(page.locator("#code-stock")).to_have_value(CODE_STOCK)
    expect(page.locator("#tools-place")).to_contain_text("plate.csv")
    expect(page.locator("#tools-known")).not_to_have_value("")
    page.goto("/dashboard/machine.html")
    expect(page.locator("#start-what, #no-programs")).to_be_attached()
    assert "plate.nc" not in (page.locator("main").text_content() or "")
    page.goto("/dashboard/verify.html")
    page.locator("#program-file").set_input_files(tmp_path / "plate.nc")
    refused = page.locator("#program-problem [role=alert]")
    expect(refused).to_have_text("plate.nc is NC code: this page needs a STEP-NC program.")


def test_code_that_is_too_deep_is_slower_and_not_green(page: Page, tmp_path: Path) -> None:
    deep = (
        "%\nO1\nG21 G90 G54\nT1 M6\nS3000 M3\nG0 X-20. Y30.\nZ-15.\nG1 X120. F{feed}\nG0 Z50.\n"
        "M30\n%\n"
    )
    (tmp_path / "slow.nc").write_text(deep.format(feed="20."))
    (tmp_path / "fast.nc").write_text(deep.format(feed="2000."))
    (tmp_path / "tools.csv").write_text("number,kind,diameter_mm,teeth\n1,endmill,10,4\n")
    page.goto("/dashboard/plan.html")
    page.locator("#program-file").set_input_files(tmp_path / "slow.nc")
    page.locator("#tools-file").set_input_files(tmp_path / "tools.csv")
    page.locator("#code-stock").fill("0,0,-20,100,60,0")
    page.locator("#material").select_option("c45")
    page.locator("#optimise").click()
    told = page.locator("#result-findings")
    expect(told).to_contain_text("Not fully checked: too deep in T1")
    expect(page.locator("#figures")).to_contain_text("saved")
    expect(page.locator("#figures .good")).to_have_count(0)
    page.locator("#program-file").set_input_files(tmp_path / "fast.nc")
    expect(page.locator("#program-shown")).to_contain_text("fast.nc")
    page.locator("#optimise").click()
    expect(told).to_contain_text("as programmed on line 8")


def test_a_program_gets_feeds_along_its_paths(page: Page) -> None:
    page.goto("/dashboard/plan.html")
    page.locator("#program-example").select_option("paper002")
    expect(page.locator("#program-shown")).to_contain_text("paper002.stpnc")
    page.locator("#machine").select_option("vmc15")
    page.locator("#nc-control").select_option("linuxcnc")
    expect(page.locator("#levels")).to_be_hidden()
    page.locator("#along").check()
    page.locator("#levels").fill("3")
    page.locator("#smooth").fill("5")
    page.locator("#more-options summary").click()
    page.locator("#simulate-after").uncheck()
    page.locator("#optimise").click()
    parts = page.locator("#along-parts tbody tr")
    expect(parts).to_have_count(1)
    expect(parts).to_contain_text("ROUGH THE FACE")
    expect(page.locator("#steps tr.step")).to_have_count(1)
    expect(page.locator("#along-figures")).to_contain_text("splits")
    smoothest = page.locator("#along-figures .figure", has_text="Smoothest profile")
    expect(smoothest).to_contain_text("times as uneven as the fastest")
    expect(drawn(page)).to_have_count(6)
    page.locator("#along-axis [data-value=time_s]").click()
    expect(page.locator("#along-plot")).to_contain_text("time, s")
    page.set_viewport_size(PHONE)
    until(lambda: overflow(page) <= 0)
    page.set_viewport_size(WIDE)
    page.reload()
    expect(page.locator("#along")).to_be_checked()
    expect(page.locator("#levels")).to_have_value("3")
    expect(page.locator("#smooth")).to_have_value("5")


def test_advice_without_the_option_shows_no_path_feeds(page: Page) -> None:
    page.goto("/dashboard/plan.html")
    page.locator("#program-example").select_option("paper002")
    page.locator("#machine").select_option("vmc15")
    page.locator("#optimise").click()
    expect(page.locator("#steps tr.step").first).to_be_visible(timeout=120_000)
    expect(page.locator("#along-card")).to_be_hidden()
    expect(page.locator("#download-feeds")).to_be_hidden()
