//! Numbers at the end of a run on the levels of a study: orders and limits against closed forms.

use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::sync::Arc;

use amontons::case::{self, Files, ReferenceRequest, Source, StudyRequest};
use amontons::convergence::{LevelValue, StudySettings, StudyTable, ValueRow, Vary, values_csv};

/// One quadrilateral, (0, 1) × (0, 1), with its boundary as a side.
const SQUARE: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n2 1 \"body\"\n1 2 \"all\"\n$EndPhysicalNames\n\
$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n$EndNodes\n\
$Elements\n5\n1 3 2 1 1 1 2 3 4\n2 1 2 2 2 1 2\n3 1 2 2 2 2 3\n4 1 2 2 2 3 4\n5 1 2 2 2 4 1\n$EndElements\n";

fn study(text: &str, vary: Vary, levels: &[usize], exact: bool) -> StudyTable {
    let files: BTreeMap<String, Arc<[u8]>> = [("square.msh".to_owned(), Arc::from(SQUARE.as_bytes()))].into();
    let source = Source { files: Files::Memory(files), ..Source::new("study.toml", text) };
    let reference = if exact { ReferenceRequest::Exact } else { ReferenceRequest::Finest };
    let request = StudyRequest { vary, levels: levels.to_vec(), reference, power: 1 };
    let study = case::study(&source, &[], &request).unwrap_or_else(|error| panic!("{error}"));
    study.run(&StudySettings::default()).unwrap_or_else(|error| panic!("{error}"))
}

fn row<'t>(table: &'t StudyTable, name: &str) -> &'t ValueRow {
    let names: Vec<&str> = table.values.iter().map(|row| row.name.as_str()).collect();
    table.values.iter().find(|row| row.name == name).unwrap_or_else(|| panic!("{name} is not among {names:?}"))
}

/// The last level, after a check that its order and its limit are those expected, within the error that is told.
#[track_caller]
fn assert_limit<'t>(table: &'t StudyTable, name: &str, order: f64, exact: f64) -> &'t LevelValue {
    let last = row(table, name).levels.last().expect("a level");
    let (Some(found), Some(limit), Some(error)) = (last.order, last.limit, last.error) else {
        panic!("{name}: {last:?}")
    };
    assert!((found - order).abs() < 0.1, "{name}: {last:?}");
    assert!((limit - exact).abs() < error && error < 0.5 * (last.value - exact).abs(), "{name}: {last:?} {exact}");
    assert!(last.remark.is_empty(), "{name}: {last:?}");
    last
}

/// θ = sin πx sin πy, held at 0 on the boundary: its value in the centre, its mean 4/π² and the heat ∫ θ.
#[test]
fn probes_of_a_known_field_have_its_orders_and_limits() {
    let text = |mesh: &str, boundary: &str| {
        format!(
            "name = \"sine\"\n[mesh]\n{mesh}\n[time]\nend = 1\nsteps = 1\n\
             [material]\nheat_capacity = 0\nconductivity = 1\n{boundary}\
             [load]\nheat_source = \"2*pi^2*sin(pi*x)*sin(pi*y)\"\n\
             [exact]\ntemperature = \"sin(pi*x)*sin(pi*y)\"\n\
             [[probe]]\nname = \"middle\"\nat = [0.5, 0.5]\nquantity = \"temperature\"\n\
             [[probe]]\nname = \"mean\"\nregion = \"body\"\ntake = \"mean\"\nquantity = \"temperature\"\n"
        )
    };
    let held = |sides: &[&str]| -> String {
        sides.iter().map(|on| format!("[[boundary]]\non = \"{on}\"\ntemperature = 0\n")).collect()
    };
    let all = held(&["left", "right", "bottom", "top"]);
    let mean = 4.0 / (PI * PI);
    for (elements, order) in [("P1", 2.0), ("Q1", 2.0), ("P2", 4.0), ("Q2", 4.0)] {
        let mesh = format!("kind = \"rectangle\"\nsize = [1.0, 1.0]\nn = 8\nelements = \"{elements}\"");
        let table = study(&text(&mesh, &all), Vary::Space, &[8, 16, 32, 64], true);
        let last = assert_limit(&table, "mean", order, mean);
        assert_eq!((last.level, row(&table, "mean").levels.len()), (64, 4));
        if order < 3.0 {
            assert_limit(&table, "middle", order, 1.0);
        }
    }
    // The same on a mesh file, whose levels are the parts of its edges; the reference is the last level.
    let table = study(&text("file = \"square.msh\"", &held(&["all"])), Vary::Space, &[4, 8, 16, 32], false);
    assert_eq!(assert_limit(&table, "mean", 2.0, mean).level, 32);
    let columns: Vec<String> = values_csv(&table.values).lines().map(str::to_owned).collect();
    assert_eq!(columns[0], "quantity,level,h,k,value,order,limit,limit_error,remark");
    assert!(columns.iter().any(|line| line.starts_with("mean,32,")));
}

/// A rod (0, 1) with E = 1, held at the right end and pressed by the force −1 onto a layer of stiffness c at the left:
/// p = c/(2(1 + c)), at whose nodes linear elements are exact, and the energy ½∫(x − p)², of order 2.
#[test]
fn exact_values_have_no_order_and_energies_have_two() {
    let text = "name = \"rod\"\n[mesh]\nkind = \"interval\"\nsize = 1.0\nn = 4\n[time]\nend = 1.0\nsteps = 1\n\
        [material]\ndensity = 0\nheat_capacity = 0\nexpansion = 0\ncoupling = 0\nconductivity = 1\n\
        elasticity = { law = \"isotropic\", young = 1.0, poisson = 0.0 }\n\
        viscosity = { law = \"lame\", first = 0.0, second = 0.0 }\n\
        [load]\nbody_force = [-1]\n[[boundary]]\non = \"right\"\ndisplacement = [0]\ntemperature = 0\n\
        [contact]\non = \"left\"\nnormal = { law = \"compliance\", stiffness = 3.0 }\n\
        [[probe]]\nname = \"pressed\"\nat = [0]\nquantity = \"pressure\"\n";
    let table = study(text, Vary::Space, &[4, 8, 16, 32], false);
    let p: f64 = 3.0 / 8.0;
    let pressed = row(&table, "pressed").levels.last().expect("a level");
    assert!(pressed.order.is_none(), "{pressed:?}");
    assert_eq!(pressed.remark, "the values agree within round-off: no order");
    assert!(pressed.limit.is_some_and(|limit| (limit - p).abs() < pressed.error.unwrap_or(0.0)), "{pressed:?}");
    assert!((pressed.value - p).abs() < 1e-12, "{pressed:?}");
    assert_limit(&table, "elastic", 2.0, ((1.0 - p).powi(3) + p.powi(3)) / 6.0);
    let force = row(&table, "contact_force_x").levels.last().expect("a level");
    assert!((force.value.abs() - p).abs() < 1e-12 && force.order.is_none(), "{force:?}");
    // Counts and the errors of the audit are no values.
    assert!(table.values.iter().all(|row| !row.name.starts_with("newton") && !row.name.ends_with("closing_error")));
}

/// A body cools by θ' = −θ: backward Euler has order 1 in the step, and the limit is e⁻¹.
#[test]
fn steps_have_orders_too() {
    let text = "name = \"cools\"\n[mesh]\nkind = \"interval\"\nsize = 1.0\nn = 1\n[time]\nend = 1.0\nsteps = 4\n\
        [material]\nheat_capacity = 1\nconductivity = 1\n[initial]\ntemperature = 1.0\n\
        [[boundary]]\non = \"left\"\nconvection = { coefficient = 1e-9, ambient = 0 }\n\
        [load]\nheat_source = \"-exp(-t)\"\n\
        [[probe]]\nname = \"theta\"\nat = [0.5]\nquantity = \"temperature\"\n";
    let table = study(text, Vary::Time, &[16, 32, 64, 128], false);
    assert_limit(&table, "theta", 1.0, (-1.0_f64).exp());
}
