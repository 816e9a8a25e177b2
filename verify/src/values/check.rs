//! The checks that a verdict consists of, each of which the tests leave out once.
//!
//! A check that nothing misses checks nothing: for each of these there is a module, a certificate or a description that is accepted, or refused for
//! another reason, without it (`tests`). What is refused because there is no other way to read it (a token that begins no item, a name
//! that nothing has) is no check in this sense: there is nothing to be left out.

#[cfg(test)]
mod tests;

use armgen_description::parallel;

/// What `of` gives for each item, on several threads; all make the checks that this one makes.
pub(crate) fn parallel_map<T: Sync, R: Send + Sync>(items: &[T], of: impl Fn(&T) -> R + Sync) -> Vec<R> {
    #[cfg(test)]
    let left_out = tests::left_out();
    parallel::parallel_map(items, |item| {
        #[cfg(test)]
        tests::leave_out(&left_out);
        of(item)
    })
}

/// A reason to refuse.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Check {
    /// Text: its length.
    Length,
    /// Text: characters that cannot be seen.
    Visible,
    /// Text: what documentation `cargo test` would run, by fences.
    Fences,
    /// Text: what documentation `cargo test` would run, by indentation or HTML.
    Indentation,
    /// Items: tokens as armgen writes them.
    Tokens,
    /// Items: signatures of functions.
    Signatures,
    /// Items: each stands once.
    Once,
    /// Items: the struct and constants that belong to functions.
    Companions,
    /// Items: private ones by their names.
    PrivateNames,
    /// Items: private ones that are called are there.
    PrivateThere,
    /// Items: private ones that are there are called.
    PrivateNeeded,
    /// Items: parts that are there are called.
    PartsNeeded,
    /// Bodies: the form of names.
    Names,
    /// Bodies: a name is given once.
    NamesOnce,
    /// Bodies: names that a compiler tells apart.
    Long,
    /// Bodies: results are written when all arguments are read.
    Aliases,
    /// Bodies: each entry of a result is written once.
    WrittenOnce,
    /// Bodies: brackets in brackets.
    Brackets,
    /// Bodies: the order of the joints in an angle.
    Angles,
    /// Bodies: sines of the angles that are asked for, and of no others.
    Lanes,
    /// Bodies: exponentials are of rates.
    Signs,
    /// Bodies: numbers are the shortest decimals.
    Shortest,
    /// Functions: entries of the result.
    Places,
    /// Functions: indices of arguments.
    Indices,
    /// Functions: velocities of Stribeck friction are those of the description.
    Velocities,
    /// Functions: those that every module has.
    Required,
    /// Functions: those that every module of an arm has that can have them.
    Optional,
    /// Functions: equal at points of prime fields.
    Modular,
    /// Functions: equal at rational points.
    Rational,
    /// Functions: the columns of a base regressor are independent.
    Columns,
    /// Functions: the odds of a miss.
    Odds,
    /// Functions: identities among them.
    Identities,
    /// Floats: divisors are those that the equations ask for.
    Divisors,
    /// Floats: signs are of gravity torques that friction grows with.
    LoadSigns,
    /// Floats: the sign of each torque is that of one step.
    SignsOnce,
    /// Floats: what does not divide has bounds in the box.
    Leaves,
    /// Floats: bounds in the box beside those of the plain program.
    Box,
    /// Floats: bounds at states beside those of the plain program.
    States,
    /// Constants: the name of the robot, before all else.
    Robot,
    /// Constants: they are there.
    ConstantsThere,
    /// Constants: their values.
    Constants,
    /// Constants: standard and base parameters are what the bodies of the description give.
    NominalParameters,
    /// Constants: names of base parameters.
    BaseNames,
    /// Constants: values of base parameters.
    BaseValues,
    /// Comments: the head of the file.
    Head,
    /// Comments: functions are those that the options of the head ask for.
    Chosen,
    /// Comments: the box of rounding errors.
    StatedBox,
    /// Comments: facts of functions stand in their documentation alone.
    Facts,
    /// Comments: a text in Python that would be a value.
    Strings,
    /// Comments: operations of a function.
    Cost,
    /// Comments: rounding errors of a function.
    Rounding,
    /// Certificates: version of the format.
    Format,
    /// Certificates: the form of the text.
    Form,
    /// Certificates: the hash of the description.
    Input,
    /// Certificates: the hash of the module.
    Output,
    /// Certificates: functions and literals are those of the module.
    Lists,
    /// Certificates: values round to the literals.
    Fits,
    /// Certificates: all that is said is what is found.
    Differences,
    /// Certificates: the work that formulas cost.
    Work,
    /// Certificates: the bits of a power.
    Powers,
    /// Inverse kinematics: the text is that of armgen.
    WholeText,
    /// Inverse kinematics: limits of the joints.
    Limits,
    /// Inverse kinematics: numbers of the loop are those of the arm.
    LoopNumbers,
    /// Inverse kinematics: numbers of coordinates are those of the coupling.
    Coordinates,
    /// Inverse kinematics: whole turns of joints are whole turns of coordinates.
    WholeTurns,
    /// Inverse kinematics: the loop closes.
    Loop,
    /// Inverse kinematics: the construction may be called with the loop.
    Class,
    /// Inverse kinematics: the room for solutions.
    MostSolutions,
    /// Inverse kinematics: every branch closes the loop.
    Sound,
    /// Inverse kinematics: as many branches as solutions at random poses.
    Branches,
    /// Inverse kinematics: solutions reach the pose.
    Reached,
    /// Inverse kinematics: where solutions meet, that is said.
    Meeting,
    /// Inverse kinematics: as many solutions as there are.
    Counts,
}

impl Check {
    /// Whether it is made: always, but in tests of this crate.
    #[cfg(not(test))]
    pub(crate) const fn is_made(self) -> bool {
        let _ = self;
        true
    }

    /// Whether it is made: unless a test leaves it out.
    #[cfg(test)]
    pub(crate) fn is_made(self) -> bool {
        !tests::is_left_out(self)
    }
}
