//! Compiles the C part with the headers of PETSc and MPI, and links them.

/// What installs them on Debian.
#[cfg(feature = "petsc")]
const INSTALL: &str = "apt-get install --no-install-recommends libpetsc-real-dev openmpi-bin";

#[cfg(not(feature = "petsc"))]
fn main() {}

#[cfg(feature = "petsc")]
fn main() {
    println!("cargo::rerun-if-changed=src/shim.c");
    println!("cargo::rerun-if-changed=src/shim.h");
    let mut shim = cc::Build::new();
    shim.file("src/shim.c").warnings(true).extra_warnings(true);
    // Under its name in Debian, and that of its own installation.
    let found =
        ["PETSc", "petsc"].iter().find_map(|name| pkg_config::Config::new().atleast_version("3.18").probe(name).ok());
    let mpi = ["ompi-c", "mpich", "mpi-c", "mpi"].iter().find_map(|name| pkg_config::probe_library(name).ok());
    let (Some(petsc), Some(mpi)) = (found, mpi) else {
        println!("cargo::error=PETSc 3.18 and MPI are not found by pkg-config; on Debian: {INSTALL}");
        return;
    };
    for library in [petsc, mpi] {
        // Headers of the system are no place for warnings.
        for path in library.include_paths {
            shim.flag(format!("-isystem{}", path.display()));
        }
        // The libraries are found at run time where they were when this was built.
        for path in library.link_paths {
            println!("cargo::rustc-link-arg=-Wl,-rpath,{}", path.display());
        }
    }
    shim.compile("amontons_shim");
}
