/** What the files of the page find: the emitted module, and what draws curves in pages with logs. */
declare const robot: any;
declare const uPlot: any;
