from simgap.report.tables import metric_tables, parameter_rows


def test_groups_with_common_keys_become_rows():
    motors = {f"motor_{index}": {"r2": 0.99, "mse": index} for index in (1, 2)}
    plain, grouped = metric_tables({"samples": 55_599} | motors)
    assert plain.rows == [["samples", "55\u202f599"]]
    assert grouped.columns == ["", "R²", "MSE"]
    assert grouped.rows == [["motor 1", "0.99", "1"], ["motor 2", "0.99", "2"]]


def test_deeper_groups_become_tables_of_their_own():
    (table,) = metric_tables({"horizon": {"position": {"h1": 0.001}, "velocity": {"h1": None, "h2": 1.5}}})
    assert table.title == "horizon"
    assert table.rows == [["position", "0.001", ""], ["velocity", "–", "1.5"]]


def test_estimates_are_found_wherever_they_stand():
    inertia = {"value": [1.0, 2.0], "std": [0.1, 0.2], "unit": "kg*m^2", "nominal": [1.5, 2.5]}
    rows = parameter_rows({"quadrotor": {"inertia": inertia, "mass": 0.045}, "note": "by least squares"})
    assert [row["name"] for row in rows] == [
        "quadrotor · inertia 1",
        "quadrotor · inertia 2",
        "quadrotor · mass",
        "note",
    ]
    assert rows[0]["value"].replace("\u00a0", " ") == "1.00 ± 0.10 kg·m²"
    assert rows[1]["nominal"] == "2.5 kg·m²"
    assert rows[3]["value"] == "by least squares"
