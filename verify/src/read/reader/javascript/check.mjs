/** That an argument has as many entries as it should. */
function check(name, values, length) {
    if (values === undefined || values === null || values.length !== length) {
        const found = values === undefined || values === null || values.length === undefined ? "no array" : `${values.length} entries`;
        throw new RangeError(`${name}: ${found} where ${length} entries are wanted`);
    }
}
