"""fit_map() of a geometry that all texels share: the same bits whatever the threads, tiles, types and strides; what is
wrong with the arguments is said. SPDX-License-Identifier: MIT"""
import dataclasses
import pickle

import numpy as np
import pytest

import brdffit
from brdffit.maps.stack import Stack
from map_case import ARRAYS, BAD_VALUE, CERTIFIED, MASKED, NO_SIGNAL, REFUSED, desk, mask, same, whole  # noqa: F401 (some are fixtures)


def test_statuses(whole, desk, mask):
    expected = np.zeros((9, 7))
    expected[~mask], expected[2, 3], expected[4, 4], expected[5, 5] = MASKED, BAD_VALUE, BAD_VALUE, NO_SIGNAL
    assert np.array_equal(whole.status, expected)
    assert whole.where[2, 3] % 3 == 1 and np.isnan(desk[0][whole.where[2, 3] // 3, 2, 3, 1])
    assert whole.where[4, 4] % 3 == 2 and np.isinf(desk[0][whole.where[4, 4] // 3, 4, 4, 2])
    assert (whole.where[whole.status != BAD_VALUE] == -1).all()
    unfitted = ~whole.fitted
    assert unfitted.sum() == 4
    for name in ARRAYS[:7]:
        assert np.isnan(getattr(whole, name)[unfitted]).all() and np.isfinite(getattr(whole, name)[~unfitted]).all()
    assert not whole.x[5, 5].any() and not whole.y[5, 5].any() and whole.certified[5, 5]
    assert whole.counts == {"certified": 58, "open": 0, "no_signal": 1, "masked": 2, "bad_value": 2, "refused": 0,
                            "no_samples": 0, "not_reached": 0}
    assert {key: whole.stats[key] for key in whole.counts} == whole.counts
    assert (whole.stats["texels"], whole.stats["equal"], whole.stats["zero_channels"], whole.stats["equal_channels"]) == (
        63, 1, 1, 1)
    assert sum(whole.samples_skipped.values()) == 84 - np.count_nonzero(desk[1][:, 2] >= np.cos(np.radians(60)) - 1e-12)
    assert [whole.STOP[i] for i in np.unique(whole.stop[whole.status == CERTIFIED])] == ["relative_gap"]
    assert (whole.stop[whole.status != CERTIFIED] == whole.STOP.index("none")).all()


@pytest.mark.parametrize("options", [{}, {"lobes": 2}, {"distribution": "blinn-phong", "quantity": "radiance"}], ids=str)
def test_as_fits_of_the_texels_alone(desk, options):
    """Each texel is what `fit` finds for it, and both proofs hold for both results; what cannot be searched in lanes
    takes the path of `fit` and has its bits."""
    stack, light, view = desk
    fits = brdffit.fit_map(stack[:, :2, :2], light, view, **options)
    quantity = options.get("quantity", "brdf")
    one = {key: value for key, value in options.items() if key != "quantity"}
    for place in np.ndindex(2, 2):
        samples = brdffit.Samples.from_arrays(light, view, stack[(slice(None), *place)], quantity=quantity)
        fit = brdffit.fit(samples, **one)
        assert fits.status[place] == CERTIFIED and fits.lower_bound[place] <= fits.e2[place]
        assert fits.e2[place] <= 1.001 * fits.lower_bound[place] * (1 + 1e-15)
        assert fits.lower_bound[place] <= fit.e2 and fit.lower_bound <= fits.e2[place]
        assert np.allclose(fits.sigma[place], fit.sigma, rtol=1e-3)
        assert np.array_equal(fits.channel_scale[place], fit.channel_scale)
        assert np.isclose(fits.sum_of_squares[place], fit.sum_of_squares, rtol=1e-13)
        # The model's error by the arithmetic of Fit.predict.
        claim = dataclasses.replace(fit, sigma=fits.sigma[place], x=fits.x[place], y=fits.y[place])
        used = light[:, 2] >= np.cos(np.radians(60)) - 1e-12
        cosine = 1 if quantity == "radiance" else light[:, 2:]
        residual = (claim.predict_samples(samples, quantity="radiance") - samples.values * cosine)[used]
        assert np.isclose(((residual / fits.channel_scale[place]) ** 2).sum(), fits.e2[place], rtol=1e-9)
    if quantity == "radiance":
        assert np.allclose(fits.exponent, 1 / fits.sigma ** 2)
    else:
        assert fits.exponent is None


def test_the_general_path_has_the_bits_of_fit(desk):
    stack, light, view = desk
    for options in ({"distribution": "ggx", "lobes": 2}, {"lobes": ["ward", "ggx"]}, {"lobes": ["ggx", "blinn-phong"]},
                    {"lobes": ["ggx", "ward", "ggx"], "relative_gap": 0.1}, {"norm": "linf"},
                    {"engine": "socp", "relative_gap": 0.1}):
        try:
            fits = brdffit.fit_map(stack[:, 0, :2], light, view, **options)
        except brdffit.UnsupportedError:
            pytest.skip("this build has no ECOS")
        for i in range(2):
            fit = brdffit.fit(brdffit.Samples.from_arrays(light, view, stack[:, 0, i]), **options)
            assert np.array_equal(fit.sigma, fits.sigma[i]) and np.array_equal(fit.y, fits.y[i])
            assert (fit.e2, fit.lower_bound, fit.boxes) == (fits.e2[i], fits.lower_bound[i], fits.boxes[i])
            assert fits.distributions == fit.distributions and fits.parameters == fit.parameters
            assert np.array_equal(fit.x, fits.x[i]) and fit.stop == fits.STOP[fits.stop[i]]


@pytest.mark.parametrize("threads", [1, 2, 7])
@pytest.mark.parametrize("tile", [None, 1, 10, 10**6])
def test_threads_and_tiles_change_nothing(whole, desk, mask, threads, tile):
    assert same(whole, brdffit.fit_map(*desk, mask=mask, threads=threads, tile=tile))


def _layouts(stack):
    """The same texels in other memory: (values, options, index of the whole map)."""
    everywhere = np.s_[:, :]
    yield np.moveaxis(stack, 0, 2).copy(), {"sample_axis": 2}, everywhere  # texel by texel
    yield np.moveaxis(stack, 3, 0).copy(), {"sample_axis": 1, "channel_axis": 0}, everywhere
    yield np.asfortranarray(stack), {}, everywhere
    yield stack[:, ::-1, ::-1], {}, np.s_[::-1, ::-1]
    yield stack[::-1, :, :, ::-1][::-1, ..., ::-1], {}, everywhere
    yield stack[:, 2:7, 1:5], {}, np.s_[2:7, 1:5]  # a crop: rows are apart
    yield stack[:, 1::3, ::2], {}, np.s_[1::3, ::2]
    yield np.repeat(stack, 2, 3)[..., ::2], {}, everywhere
    yield stack.astype(np.float64), {}, everywhere
    yield stack.astype(">f4"), {}, everywhere  # the other byte order
    packed = np.zeros(stack.size * 4 + 1, np.uint8)
    packed[1:] = stack.reshape(-1).view(np.uint8)
    yield packed[1:].view(np.float32).reshape(stack.shape), {}, everywhere  # not aligned
    records = np.zeros(stack.shape, [("tag", np.uint8), ("value", np.float32)])
    records["value"] = stack
    yield records["value"], {}, everywhere  # strides that are no multiple of the item
    still = stack.copy()
    still.flags.writeable = False
    yield still, {}, everywhere
    yield stack.tolist(), {}, everywhere


def test_layouts_change_nothing(whole, desk, mask):
    stack, light, view = desk
    for values, options, index in _layouts(stack):
        before = values.copy() if isinstance(values, np.ndarray) else None
        for tile in (None, 4):
            assert same(whole, brdffit.fit_map(values, light, view, mask=mask[index], tile=tile, **options), index)
        assert before is None or np.array_equal(values, before, equal_nan=True)


def test_long_rows_of_a_crop_are_read_where_they_lie(desk):
    """Rows of 40 texels in one of 50: blocks are views, cut where a row and where a tile ends."""
    stack, light, view = desk
    wide = np.tile(stack[:, :3, :5], (1, 1, 10, 1))
    crop = wide[:, :, 7:47]
    laid = Stack(crop, 0, -1)
    assert laid.in_place and [block[1:] for block in laid.blocks(30, 60)] == [(30, 10), (40, 40), (80, 10)]
    assert all(np.shares_memory(block.values, wide) for block in laid.blocks(0, 120))
    assert same(brdffit.fit_map(np.ascontiguousarray(crop), light, view), brdffit.fit_map(crop, light, view, tile=30))
    assert not Stack(wide[:, :, ::50], 0, -1).in_place or Stack(wide[:, :, ::50], 0, -1).run == 3


def test_spatial_axes(whole, desk, mask):
    """Any number of them, none too; no axis of channels."""
    stack, light, view = desk
    flat = brdffit.fit_map(stack.reshape(84, 63, 3), light, view, mask=mask.reshape(63))
    assert flat.shape == (63,) and np.array_equal(flat.e2.reshape(9, 7), whole.e2, equal_nan=True)
    cube = brdffit.fit_map(stack.reshape(84, 3, 3, 7, 1, 3), light, view)
    assert cube.shape == (3, 3, 7, 1) and cube.y.shape == (3, 3, 7, 1, 3, 1) and cube.e2[0, 0, 0, 0] == whole.e2[0, 0]
    one = brdffit.fit_map(stack[:, 3, 2], light, view)
    assert one.shape == () and one.sigma.shape == (1,) and one.e2 == whole.e2[3, 2] and "of 1 texel, 3" in repr(one)
    grey = brdffit.fit_map(stack[..., 0], light, view, channel_axis=None, lobes=2)
    assert grey.x.shape == (9, 7, 1) and grey.y.shape == (9, 7, 1, 2) and grey.channels == 1 and grey.lobes == 2
    assert same(grey, brdffit.fit_map(stack[..., :1], light, view, lobes=2))


def test_other_numbers_and_scale(desk):
    stack, light, view = desk
    counts = np.round(np.clip(stack[:, :2, :3], 0, 5) * 10000).astype(np.uint16)
    scaled = brdffit.fit_map(counts, light, view, scale=1e-4)
    assert same(scaled, brdffit.fit_map(counts.astype(np.float64) * 1e-4, light, view))
    bytes_ = (counts // 256).astype(np.uint8)
    expected = brdffit.fit_map(bytes_.astype(np.float64), light, view)
    for kind in (np.uint8, np.int32, np.int64, np.uint64, np.float16, np.longdouble, object, ">u2"):
        assert same(expected, brdffit.fit_map(bytes_.astype(kind), light, view)), kind
    assert brdffit.fit_map(bytes_ > 20, light, view).fitted.all()


def test_weights_views_and_samples_as_geometry(desk):
    stack, light, view = desk
    part = stack[:, :2, :3]
    weights = np.where(np.arange(84) % 5 == 0, 0.0, 1.0)
    spoilt = part.copy()
    spoilt[weights == 0] = np.nan  # not looked at
    weighted = brdffit.fit_map(spoilt, light, view, weights=weights)
    assert (weighted.status == CERTIFIED).all() and weighted.samples_skipped["zero_weight"] == 17
    keep = weights > 0
    assert np.allclose(weighted.sigma, brdffit.fit_map(part[keep], light[keep], view[keep]).sigma, rtol=1e-3)
    geometry = brdffit.Samples.from_arrays(4 * light, view, np.zeros(84), weights=weights)
    assert same(weighted, brdffit.fit_map(spoilt, geometry))
    assert same(brdffit.fit_map(part, light), brdffit.fit_map(part, light, [0, 0, 1]))
    assert same(brdffit.fit_map(part, light, [0, 0, 1]), brdffit.fit_map(part, light, np.tile([0, 0, 2.0], (84, 1))))
    turn = np.array([[0, 0, 1], [1, 0, 0], [0, 1, 0]], float)
    turned = brdffit.fit_map(part, light @ turn, view @ turn, normal=np.array([0, 0, 1]) @ turn)
    assert np.allclose(turned.sigma, brdffit.fit_map(part, light, view).sigma, rtol=1e-6)
    a, b, c = np.random.default_rng(2).uniform(0.1, 1, (3, 84))
    values = a[:, None] + b[:, None] * np.exp(-9 * c[:, None])
    by_abc = brdffit.fit_map(values, brdffit.Samples.from_coefficients(a, b, c, np.zeros(84)))
    assert by_abc.quantity == "radiance" and np.isclose(by_abc.sigma[0], 1 / 3, rtol=1e-2)


def test_mask_of_numbers(desk, whole):
    stack, light, view = desk
    mask = np.zeros((9, 7))
    mask[0, 0], mask[1, 1], mask[2, 2] = 0.5, -1, np.nan
    fits = brdffit.fit_map(stack, light, view, mask=mask)
    assert fits.counts["certified"] == 2 and fits.e2[1, 1] == whole.e2[1, 1] and fits.status[2, 2] == MASKED
    assert same(fits, brdffit.fit_map(stack, light, view, mask=np.asfortranarray(mask).astype(np.float32)))
    assert same(fits, brdffit.fit_map(stack, light, view, mask=(np.nan_to_num(mask) != 0).astype(int)))


@pytest.mark.parametrize("shape, results", [((84, 0, 5, 3), (0, 5)), ((84, 0, 3), (0,))])
def test_no_texels(shape, results, desk):
    fits = brdffit.fit_map(np.empty(shape), *desk[1:])
    assert fits.shape == results and fits.y.shape == (*results, 3, 1) and fits.stats["texels"] == 0
    assert "0 texels" in repr(fits) and fits._repr_html_() and fits.predict([0, 0, 1]).shape == (*results, 3)


@pytest.mark.parametrize("change, kind, words", [
    ({"values": np.zeros((83, 2, 2, 3))}, brdffit.DataError, "83 samples|83"),
    ({"values": np.zeros(84)}, brdffit.DataError, "axis of samples"),
    ({"values": np.float64(3)}, brdffit.DataError, "axis of samples"),
    ({"values": np.zeros((84, 2, 2, 0))}, brdffit.BrdffitError, "channel"),
    ({"values": np.zeros((84, 2, 2, 3), complex)}, brdffit.DataError, "not an array of numbers"),
    ({"values": np.full((84, 2, 2, 3), "x")}, brdffit.DataError, "not an array of numbers"),
    ({"values": np.ma.zeros((84, 2, 2, 3))}, brdffit.DataError, "masked array"),
    ({"values": np.zeros((0, 2, 2, 3)), "light": np.zeros((0, 3)), "view": None}, brdffit.DataError, "no_samples|sample"),
    ({"light": np.zeros((84, 2))}, brdffit.DataError, "3 components"),
    ({"light": np.zeros((83, 3))}, brdffit.DataError, "light must have shape"),
    ({"light": np.zeros((84, 3))}, brdffit.DataError, "sample 0"),
    ({"view": np.full((84, 3), np.nan)}, brdffit.DataError, "sample 0"),
    ({"view": np.zeros((84, 2, 3, 3))}, brdffit.DataError, "view must have shape"),
    ({"light": [0, 0, -1]}, brdffit.DataError, "sample"),
    ({"normal": np.zeros((2, 3, 3))}, brdffit.DataError, "normal must have shape"),
    ({"weights": np.ones(83)}, brdffit.DataError, "weights must have shape"),
    ({"weights": -np.ones(84)}, brdffit.DataError, "sample 0"),
    ({"mask": np.ones((2, 3))}, brdffit.DataError, "mask must have shape"),
    ({"mask": np.full((2, 2), "a")}, brdffit.DataError, "mask must be"),
    ({"scale": 0}, brdffit.OptionError, "scale"), ({"scale": np.inf}, brdffit.OptionError, "scale"),
    ({"scale": "x"}, brdffit.OptionError, "scale"),
    ({"sample_axis": 4}, brdffit.DataError, "sample_axis"), ({"channel_axis": 0}, brdffit.DataError, "same axis"),
    ({"channel_axis": 1.0}, brdffit.DataError, "channel_axis"),
    ({"threads": 0}, brdffit.OptionError, "threads"), ({"threads": 1.5}, brdffit.OptionError, "threads"),
    ({"tile": -1}, brdffit.OptionError, "tile"), ({"errors": "ignore"}, brdffit.OptionError, "errors"),
    ({"quantity": "x"}, brdffit.OptionError, "quantity"), ({"lobes": 4}, brdffit.OptionError, "lobes"),
    ({"sigma_range": (2, 1)}, brdffit.OptionError, "sigma"), ({"distribution": "x"}, brdffit.OptionError, "distribution"),
])
def test_bad_arguments(desk, change, kind, words):
    arguments = {"values": np.ones((84, 2, 2, 3)), "light": desk[1], "view": desk[2], **change}
    with pytest.raises(kind, match=words) as caught:
        brdffit.fit_map(arguments.pop("values"), arguments.pop("light"), **arguments)
    assert caught.value.code in ("argument", "option", "value", "no_samples")


def test_zero_dimensional_options(desk, whole):
    stack, light, view = desk
    fits = brdffit.fit_map(stack, light, view, lobes=np.array(1), relative_gap=np.array(1e-3), scale=np.array(1.0),
                           threads=np.int64(2), tile=np.array(5), sample_axis=np.int8(0))
    assert same(fits, brdffit.fit_map(stack, light, view))


def test_errors_that_are_raised(desk, mask):
    stack, light, view = desk
    for threads in (1, 2, 7):
        with pytest.raises(brdffit.DataError) as caught:
            brdffit.fit_map(stack, light, view, mask=mask, errors="raise", tile=3, threads=threads)
        error = caught.value
        assert (error.code, error.texel, error.channel) == ("value", (2, 3), 1) and np.isnan(error.value)
        assert np.isnan(stack[error.sample, 2, 3, 1]) and "texel (2, 3), sample %d, channel 1" % error.sample in str(error)
    again = pickle.loads(pickle.dumps(error))
    assert again.texel == (2, 3) and str(again) == str(error)
    assert (brdffit.fit_map(stack[:, 5:], light, view, errors="raise").status <= NO_SIGNAL).all()


def test_refused_texels(desk):
    stack, light, view = desk
    tiny = stack[:, :1, :2].astype(float)
    tiny[:, 0, 1] *= 1e-320
    fits = brdffit.fit_map(tiny, light, view)
    assert list(fits.status[0]) == [CERTIFIED, REFUSED]
    with pytest.raises(brdffit.BrdffitError) as caught:
        brdffit.fit_map(tiny, light, view, errors="raise")
    with pytest.raises(brdffit.BrdffitError) as alone:
        brdffit.fit(brdffit.Samples.from_arrays(light, view, tiny[:, 0, 1]))
    assert caught.value.texel == (0, 1) and caught.value.message == alone.value.message


def test_a_map_is_frozen_and_travels(whole):
    with pytest.raises(dataclasses.FrozenInstanceError):
        whole.e2 = 0
    with pytest.raises(ValueError):
        whole.sigma[0] = 1
    again = pickle.loads(pickle.dumps(whole))
    assert same(whole, again) and not again.sigma.flags.writeable
    assert np.array_equal(whole.gap, np.maximum(whole.e2 - whole.lower_bound, 0), equal_nan=True)


def test_what_people_read(whole):
    text = repr(whole)
    assert "84 samples of 9 x 7 texels, 3 channels" in text and "58 certified, 1 without signal, 2 masked" in text
    assert "texel (2, 3), sample" in text and "within 0.1 %" in text and max(map(len, text.splitlines())) <= 79
    html = whole._repr_html_()
    assert html.count("<table>") == 2 and "58" in html and "without signal" in html
