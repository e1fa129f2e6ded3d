"""The paper to the letter: Seel, Raisch and Schauer 2014, doi 10.3390/s140406891, equations 2 to 15."""
