//! The text of a case that tests begin with.

/// A case of an elastic body with the entries of its tables `mesh` and `time`, its density, and the numbers of its
/// isotropic law. What follows may begin with further keys of the material.
macro_rules! body {
    ($mesh:literal, $time:literal, $density:literal, $elastic:literal, $rest:literal) => {
        concat!(
            "name = \"body\"\nmesh = { ",
            $mesh,
            " }\ntime = { ",
            $time,
            " }\n[material]\ndensity = ",
            $density,
            "\nelasticity = { law = \"isotropic\", ",
            $elastic,
            " }\n",
            $rest
        )
    };
}
