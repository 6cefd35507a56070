"""The clusterings on one coordinate and on cells are DBSCAN: scikit-learn is the oracle."""

import tracemalloc

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stair_inspector.geometry import clusters as clustering
from stair_inspector.geometry.clusters import cluster_cells, cluster_sorted, find_reach

N_BINARY_DIGITS = 64


def cluster(values, eps, min_points):
    return cluster_sorted(find_reach(np.sort(np.asarray(values, dtype=np.float64)), eps), min_points)


def labels_of(clusters, n):
    labels = np.full(n, -1)
    for label, (start, stop) in enumerate(zip(clusters.start, clusters.stop, strict=True)):
        assert (labels[start:stop] == -1).all(), "a value in two clusters"
        labels[start:stop] = label
    return labels


def assert_is_dbscan(values, eps, min_points, algorithm="kd_tree"):
    """Equal to scikit-learn in core points, noise, number of clusters and partition of the core points."""
    from sklearn import cluster as sklearn_cluster

    ordered = np.sort(np.asarray(values, dtype=np.float64))
    n = len(ordered)
    ours = cluster_sorted(find_reach(ordered, eps), min_points)
    labels = labels_of(ours, n)
    oracle = sklearn_cluster.DBSCAN(eps=eps, min_samples=min_points, algorithm=algorithm).fit(ordered[:, None])
    is_core = np.zeros(n, dtype=bool)
    is_core[oracle.core_sample_indices_] = True

    np.testing.assert_array_equal(ours.is_core, is_core, err_msg="core points")
    np.testing.assert_array_equal(labels == -1, oracle.labels_ == -1, err_msg="noise")
    assert len(ours.start) == len(set(oracle.labels_) - {-1}), "number of clusters"
    # Same partition: the pairs of labels of the core points are one to one.
    pairs = set(zip(labels[is_core], oracle.labels_[is_core], strict=True))
    assert len(pairs) == len({ours for ours, _ in pairs}) == len({theirs for _, theirs in pairs}), "partition"
    for i in np.flatnonzero((labels >= 0) & ~is_core):
        cores = ordered[is_core & (labels == labels[i])]
        assert ((cores - ordered[i]) ** 2 <= eps * eps).any(), "a border value has a core value of its cluster in reach"


dyadic = st.lists(st.integers(-64, 64).map(lambda n: n / N_BINARY_DIGITS), min_size=1, max_size=120)
decimal = st.lists(st.integers(-20, 40).map(lambda n: n * 0.01), min_size=1, max_size=120)
anywhere = st.lists(st.floats(-3.0, 3.0, allow_subnormal=False), min_size=1, max_size=120)
crowded = st.lists(st.floats(0.0, 0.2, allow_subnormal=False), min_size=1, max_size=120)
min_points = st.integers(1, 12)


@given(dyadic, st.integers(1, 16), min_points)
def test_equals_sklearn_where_distances_equal_eps_exactly(values, eps_64ths, m):
    assert_is_dbscan(values, eps_64ths / N_BINARY_DIGITS, m)


@given(dyadic, st.integers(1, 16), min_points)
def test_equals_sklearn_brute_force_where_squares_are_exact(values, eps_64ths, m):
    assert_is_dbscan(values, eps_64ths / N_BINARY_DIGITS, m, algorithm="brute")


@given(decimal, st.sampled_from([0.01, 0.02, 0.03, 0.07]), min_points)
def test_equals_sklearn_where_rounding_decides_about_eps(values, eps, m):
    assert_is_dbscan(values, eps, m)


@given(st.one_of(anywhere, crowded), st.floats(0.001, 0.5), min_points)
def test_equals_sklearn_on_any_values(values, eps, m):
    assert_is_dbscan(values, eps, m)


@given(anywhere, st.floats(0.001, 0.5), min_points)
def test_equals_sklearn_with_its_own_choice_of_algorithm(values, eps, m):
    assert_is_dbscan(values, eps, m, algorithm="auto")


@pytest.mark.parametrize("seed", range(5))
def test_equals_sklearn_on_the_heights_of_a_stair(seed):
    rng = np.random.default_rng(seed)
    treads = np.repeat(np.arange(6) * 0.17, 300) + rng.normal(0.0, 0.004, 1800)
    values = np.concatenate([treads, rng.uniform(-0.1, 1.0, 200)])
    for m in (1, 5, 30, 120):
        assert_is_dbscan(values, 0.02, m)


@pytest.mark.parametrize("step", [0.01, 0.02, 0.1, 1e-3])
def test_equals_sklearn_on_an_even_comb_with_eps_its_pitch(step):
    # 0.01 * n differs from its neighbour by slightly more or less than 0.01: the comparison itself is under test.
    for m in (1, 2, 3, 4):
        assert_is_dbscan(np.arange(300) * step, step, m)


@pytest.mark.parametrize("piece", [1, 7, 299, 300, 301])
def test_neighbourhoods_that_reach_over_the_ends_of_pieces_are_whole(piece, monkeypatch):
    monkeypatch.setattr(clustering, "_PIECE", piece)
    ties = np.sort(np.round(np.random.default_rng(piece).uniform(0.0, 1.5, 300), 2))
    for values, eps in ((np.arange(300) * 0.01, 0.01), (ties, 0.01), (ties, 0.1), (ties, 2.0)):
        reach = find_reach(values, eps)
        is_near = (values[:, None] - values) ** 2 <= eps * eps
        np.testing.assert_array_equal(reach.stop, 300 - is_near[:, ::-1].argmax(axis=1))
        np.testing.assert_array_equal(reach.first, is_near.argmax(axis=1))


@pytest.mark.parametrize(("a", "b", "eps"), [(-0.04, -0.01, 0.03), (-0.02, 0.01, 0.03), (-0.07, -0.02, 0.05)])
def test_equals_sklearn_where_a_search_for_a_plus_eps_would_stop_short(a, b, eps):
    assert a + eps < b
    assert (b - a) ** 2 <= eps**2
    assert_is_dbscan([a, b], eps, 2)
    assert len(cluster([a, b], eps, 2).start) == 1


def test_equals_sklearn_where_that_search_would_stop_several_values_short():
    # Beside 0.03 they all vanish in rounding.
    values = [-0.03, 1e-19, 2e-19, 3e-19]
    assert_is_dbscan(values, 0.03, 4)
    assert cluster(values, 0.03, 4).is_core.all()


def test_nothing_gives_no_clusters():
    clusters = cluster([], 0.1, 1)
    assert len(clusters.start) == len(clusters.stop) == len(clusters.is_core) == 0


@pytest.mark.parametrize(("m", "expected"), [(1, [(0, 1)]), (2, [])])
def test_a_single_value_is_a_cluster_only_for_m_of_one(m, expected):
    clusters = cluster([0.3], 0.1, m)
    assert list(zip(clusters.start, clusters.stop, strict=True)) == expected


@pytest.mark.parametrize(("m", "n_clusters"), [(7, 1), (8, 0)])
def test_equal_values_count_each_other_and_themselves(m, n_clusters):
    assert len(cluster([0.25] * 7, 0.01, m).start) == n_clusters


def test_values_exactly_eps_apart_are_neighbours():
    assert len(cluster([0.0, 0.25, 0.5], 0.25, 2).start) == 1
    assert len(cluster([0.0, 0.25, 0.5], np.nextafter(0.25, 0.0), 2).start) == 0


def test_a_border_value_between_two_clusters_goes_to_the_lower():
    # 1.0 reaches 0.0 and 2.0 but, with three values in reach, is no core value of m = 6.
    clusters = cluster([-0.5] * 5 + [0.0, 1.0, 2.0] + [2.5] * 5, 1.0, 6)
    assert list(zip(clusters.start, clusters.stop, strict=True)) == [(0, 7), (7, 13)]
    np.testing.assert_array_equal(clusters.is_core, [True] * 6 + [False] + [True] * 6)


def test_a_core_value_between_two_groups_joins_them():
    values = [0.0] * 5 + [1.0] + [2.0] * 5
    joined, parted = cluster(values, 1.0, 6), cluster(values, 1.0, 12)
    assert list(zip(joined.start, joined.stop, strict=True)) == [(0, 11)]
    assert len(parted.start) == 0


def test_memory_is_linear_in_a_dense_cluster():
    # Every value has every other in reach: lists of neighbours would take 8 n**2 bytes, 320 GB.
    values = np.sort(np.random.default_rng(0).normal(0.0, 0.002, 200_000))
    tracemalloc.start()
    clusters = cluster_sorted(find_reach(values, 0.02), 50)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert len(clusters.start) == 1
    assert peak < 200 * len(values)


def test_the_input_is_left_alone():
    values = np.array([0.1, 0.2, 0.4])
    values.flags.writeable = False
    reach = find_reach(values, 0.1)
    assert not reach.first.flags.writeable
    assert not reach.stop.flags.writeable


# cells of a grid


def assert_cells_are_dbscan(places, heights, counts, min_points):
    """Equal to scikit-learn in every label, the numbers of the clusters and the border cells included."""
    from sklearn import cluster as sklearn_cluster

    labels = cluster_cells(places, heights, counts, min_points)
    # Layers so far apart that they do not touch.
    apart = np.stack([3.0 * places[0], *places[1:], heights], axis=1)
    oracle = sklearn_cluster.DBSCAN(eps=1.0, min_samples=min_points, metric="chebyshev", algorithm="brute")
    np.testing.assert_array_equal(labels, oracle.fit(apart, sample_weight=counts).labels_)
    return labels


def cells_of(layers, share, seed, relief=0.8):
    """A share of the cells of some layers, in order, with random heights and weights."""
    rng = np.random.default_rng(seed)
    places = np.stack(np.nonzero(rng.random(layers) < share))
    return places, rng.normal(0.0, relief, places.shape[1]), rng.integers(1, 10, places.shape[1])


cells = st.sets(st.tuples(st.integers(0, 2), st.integers(0, 5), st.integers(0, 5)), min_size=1, max_size=60)


@given(cells, st.data(), st.integers(1, 40))
def test_cells_equal_sklearn_where_steps_equal_the_largest_exactly(places, data, min_points):
    n = len(places)
    quarters = data.draw(st.lists(st.integers(-6, 6), min_size=n, max_size=n))
    counts = data.draw(st.lists(st.integers(1, 9), min_size=n, max_size=n))
    assert_cells_are_dbscan(np.array(sorted(places)).T, np.array(quarters) / 4.0, np.array(counts), min_points)


@pytest.mark.parametrize("share", [0.15, 0.35, 0.6, 1.0])
@pytest.mark.parametrize("min_points", [1, 12, 30, 44])
def test_cells_of_several_layers_equal_sklearn(share, min_points):
    for seed in range(4):
        assert_cells_are_dbscan(*cells_of((3, 25, 17), share, seed), min_points)


def test_cells_that_join_late_are_one_cluster():
    # Two spirals, one inside the other, that meet in their middle: neighbours along them lie far apart in order.
    turn = np.linspace(0.0, 6.0 * np.pi, 4000)
    arms = [np.stack([turn * np.cos(turn + start), turn * np.sin(turn + start)]) for start in (0.0, np.pi)]
    plan = np.unique(np.rint(3.0 * np.concatenate(arms, axis=1)).astype(int) + 60, axis=1)
    n = plan.shape[1]
    labels = assert_cells_are_dbscan(np.stack([np.zeros(n, dtype=int), *plan]), np.zeros(n), np.ones(n, dtype=int), 1)
    assert (labels == 0).all()


def test_a_border_cell_goes_to_the_first_cluster_that_reaches_it():
    places = np.array([[0, 0, 0, 0, 0], [0, 1, 2, 3, 4], [0, 0, 0, 0, 0]])
    # With their neighbours they hold 10, 11, 5, 11 and 10 points.
    counts = np.array([8, 2, 1, 2, 8])
    np.testing.assert_array_equal(assert_cells_are_dbscan(places, np.zeros(5), counts, 10), [0, 0, 0, 1, 1])
    np.testing.assert_array_equal(assert_cells_are_dbscan(places, np.zeros(5), counts, 11), [0, 0, 0, 1, 1])
    np.testing.assert_array_equal(assert_cells_are_dbscan(places, np.zeros(5), counts, 12), [-1] * 5)


def test_cells_at_the_ends_of_rows_columns_and_layers_do_not_touch():
    last, first = np.array([[0, 0], [0, 0], [0, 7]]), np.array([[0, 1], [1, 0], [0, 0]])
    places = np.concatenate([last, first], axis=1)
    places = places[:, np.lexsort(places[::-1])]
    labels = assert_cells_are_dbscan(places, np.zeros(4), np.ones(4, dtype=int), 1)
    # The first of a row and the first of the next touch; the last of a row and the first of the next do not.
    np.testing.assert_array_equal(labels, [0, 1, 0, 2])


def test_no_cells_have_no_labels():
    assert cluster_cells(np.zeros((3, 0), dtype=int), np.zeros(0), np.zeros(0, dtype=int), 3).shape == (0,)
